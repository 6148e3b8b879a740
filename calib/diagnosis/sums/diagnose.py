"""Diagnoses `statistics.csv`: whether the response bends, and whether charge repels charge.

A mean and a variance of each block are left. The plain model is a straight response and a straight
photon-transfer curve; beside it are fitted an offset of the exposure, the unrest of the source
(eta, of the means) and the overdispersion of the variances (tau). What bends, `calib.transfer.
photon_transfer` decides: a bent response bends means and variances together, charge that repels
bends variances alone. All else needs the frames.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.answer.diagnosis import Diagnosis, Fit, Unexplained
from calib.diagnosis.answer.figures import Figures
from calib.diagnosis.answer.finding import Finding, NamedCandidate, Where
from calib.diagnosis.answer.locate import placed
from calib.diagnosis.baseline.fitted_links import BASELINE
from calib.diagnosis.naming.heldout import HeldOut
from calib.diagnosis.naming.remainder import CERTAIN_SIGMA
from calib.diagnosis.sums import words
from calib.diagnosis.sums.names import EFFECTS, departure, names_of, parameters
from calib.diagnosis.sums.prediction import Predicted, held_out, left_out, saturated
from calib.diagnosis.sums.scatter import scatter_sigma
from calib.diagnosis.words.verdict import first_sentence
from calib.recording.folder_recording import FolderRecording
from calib.recording.header import RecordingHeader
from calib.transfer.photon_transfer.curve_fit import CurveFit, Model
from calib.transfer.photon_transfer.measure import photon_transfer
from calib.transfer.photon_transfer.result import PhotonTransfer
from calib.transfer.photon_transfer.tap_transfer import TapTransfer

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SumsExamination:
    """All that the diagnosis of sums rests on.

    Attributes:
        header: Of the recording.
        measured: Its photon transfer.
        model: What is called for.
        diagnosis: The answer.
    """

    header: RecordingHeader
    measured: PhotonTransfer
    model: Model
    diagnosis: Diagnosis

    @property
    def fit(self) -> CurveFit:
        """That of what is called for."""
        return self.measured.taps[0].choice.fits[self.model]


def diagnose_sums(recording: FolderRecording) -> SumsExamination:
    """Return what the sums of `recording` show beyond the plain model.

    Raises:
        NotDeterminedError: There are no variances, or no flats between the ends of the codes.
    """
    measured = photon_transfer(recording)
    tap = measured.taps[0]
    called = tap.choice.called_for
    asked = _Asked(tap, recording.header, tuple(b.block.block for b in measured.recorded.blocks))
    # Variances alone do not tell the two apart: whatever bends may be either.
    final = Model.NONLINEAR if called is Model.QUADRATIC else called
    before, after = asked.heldout(Model.STRAIGHT), asked.heldout(final)
    findings = tuple(asked.finding(name, final) for name in names_of(final))
    diagnosis = Diagnosis(
        Fit(BASELINE, before.deviance, before.dof),
        tuple(sorted(findings, key=lambda f: -f.significance_sigma)),
        Fit((*BASELINE, *names_of(final)), after.deviance, after.dof),
        asked.unexplained(final),
        words.not_testable(recording.header, tap.choice.fits[final]),
        (),
        asked.figures(final),
        remarks=(*words.remarks(tap, final), *measured.warnings),
    )
    diagnosis = replace(diagnosis, summary=first_sentence(diagnosis))
    return SumsExamination(recording.header, measured, final, diagnosis)


@dataclass(frozen=True)
class _Asked:
    """One tap, and the questions that a diagnosis asks of it."""

    tap: TapTransfer
    header: RecordingHeader
    blocks: tuple[str, ...]

    def heldout(self, model: Model) -> HeldOut:
        return held_out(self.folds(model))

    def folds(self, model: Model) -> tuple[Predicted, ...]:
        if model not in self._folds:
            points = self.tap.points.where(self.tap.used.use)
            self._folds[model] = left_out(points, self.tap.means, model)
        return self._folds[model]

    @cached_property
    def _folds(self) -> dict[Model, tuple[Predicted, ...]]:
        return {}

    def finding(self, name: str, model: Model) -> Finding:
        fit = self.tap.choice.fits[model]
        without = Model(tuple(n for n in model.value if EFFECTS[n] != name))
        before, after = self.heldout(without), self.heldout(model)
        missed = max(before.deviance - saturated(self.folds(model)), 1e-9)
        return Finding(
            departure(name, fit.shape),
            self._candidates(name, model, after),
            words.sigma_of(self.tap.choice, name),
            self._where(name, without),
            parameters(name, fit),
            before.deviance,
            after.deviance,
            float(np.clip((before.deviance - after.deviance) / missed, 0.0, 1.0)),
            words.sentence(name, fit.shape, float(fit.data.points.signal_dn.max())),
        )

    def _candidates(self, name: str, model: Model, after: HeldOut) -> tuple[NamedCandidate, ...]:
        """Return the names that a single bend may have, by the likelihood of the whole curve."""
        if len(model.value) > 1:
            return (NamedCandidate(name, 1.0, after.deviance),)
        fits = self.tap.choice.fits
        others = {EFFECTS[m.value[0]]: m for m in (Model.NONLINEAR, Model.BRIGHTER_FATTER)}
        least = min(fits[m].deviance for m in others.values())
        weight = {n: float(np.exp(-0.5 * (fits[m].deviance - least))) for n, m in others.items()}
        total = sum(weight.values())
        found = [
            NamedCandidate(n, weight[n] / total, self.heldout(m).deviance)
            for n, m in others.items()
            if n == name or weight[n] / total >= words.LEAST_PROBABILITY
        ]
        return tuple(sorted(found, key=lambda c: -c.probability))

    def _where(self, name: str, without: Model) -> Where:
        """Return where the model without the effect misses most."""
        misses = self._misses(without)[:, int(name == "brighter_fatter")]
        last = self.header.camera.columns - 1
        statistic = "variance" if name == "brighter_fatter" else "mean"
        return placed(statistic, ("signal",), misses**2, (0, last), self.blocks)

    def _misses(self, model: Model) -> Floats:
        """Return by how many standard deviations means and variances miss, (n_blocks, 2)."""
        fit, points = self.tap.choice.fits[model], self.tap.points.where(self.tap.used.use)
        found = np.zeros((len(self.blocks), 2))
        residual, own, size = fit.data.variance_errors(fit.shape)
        tau2 = fit.variance_excess.tau2(points.is_dark)
        found[points.block, 1] = residual / np.sqrt(own + tau2 * size)
        if fit.data.means is not None and fit.mean_excess is not None:
            residual, own, size = fit.data.mean_errors(fit.solution.parameters)
            eta2 = self.tap.choice.fits[_bendable(self.tap)].mean_excess
            spread = own + (eta2.relative**2 if eta2 is not None else 0.0) * size
            found[fit.data.means.block, 0] = residual / np.sqrt(spread)
        return found

    def unexplained(self, model: Model) -> Unexplained | None:
        """Return the scatter of the variances that statistics do not allow, where it is sure."""
        fit = self.tap.choice.fits[model]
        flats = fit.variance_excess.flats
        sigma = scatter_sigma(flats)
        if sigma <= CERTAIN_SIGMA:
            return None
        misses = np.zeros(len(self.blocks))
        misses[self.tap.points.where(self.tap.used.use).block] = fit.residual / fit.sigma
        last = self.header.camera.columns - 1
        place = placed("variance", ("signal",), misses**2, (0, last), self.blocks)
        return Unexplained(
            sigma,
            Where(
                place.statistic, place.depends_on, place.columns, place.blocks,
                words.overdispersion(fit),
            ),
        )  # fmt: skip

    def figures(self, model: Model) -> Figures:
        looks = (("variance", scatter_sigma(self.tap.choice.fits[model].variance_excess.flats)),)
        return Figures(self._misses(Model.STRAIGHT), self._misses(model), self.blocks, looks)


def _bendable(tap: TapTransfer) -> Model:
    """Return the model of most bends, whose unrest of the source is that of the source alone."""
    return max(tap.choice.fits, key=lambda m: len(m.value))
