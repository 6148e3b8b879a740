"""One step of a run: a block, and what has to be done before its lines are exposed."""

from dataclasses import dataclass

from calib.recording.header import Block


@dataclass(frozen=True)
class Step:
    """Set the conditions, wait until they are steady, take the block's lines.

    Attributes:
        index: Position in the run, from 0.
        block: The conditions as planned; what was read back comes with the recording.
        burning: The level that burns meanwhile, behind the cap of a dark too.
        lines: How many lines are taken.
        wait_s: A wait that the plan asks for, conditions set.
        off_afterwards: True where the plan wants the lamps off once the block is taken.
    """

    index: int
    block: Block
    burning: float
    lines: int
    wait_s: float = 0.0
    off_afterwards: bool = False

    @property
    def capped(self) -> bool:
        """True where no light may reach the sensor."""
        return self.block.kind == "dark"

    @property
    def line(self) -> str:
        """One line of text that says what the step does."""
        what = "capped" if self.capped else f"level {self.block.level:g}"
        if self.block.scene:
            what += f", scene {self.block.scene}"
        return (
            f"{self.block.block}  {self.block.kind:<5} {self.block.exposure_us:>10.1f} µs"
            f"  {self.lines:>6} lines  {what}"
        )
