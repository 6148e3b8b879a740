"""What this machine and bench have, what they lack, and the command that mends it."""

from service.doctor.examination import examine
from service.doctor.finding import Finding

__all__ = ["Finding", "examine"]
