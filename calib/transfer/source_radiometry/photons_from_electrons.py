"""From photo-electrons to the photons that made them."""

from math import hypot

from calib.errors import InputError
from calib.transfer.estimate import Estimate


def photons_from_electrons(photoelectrons: Estimate, quantum_efficiency: Estimate) -> Estimate:
    """Return photons = photo-electrons / quantum efficiency, with both uncertainties.

    u^2(photons) / photons^2 = u^2(electrons) / electrons^2 + u^2(QE) / QE^2, to first order; the
    two are independent, and QE is the mean over the pixels at the light's wavelength.

    Source: Yielding, Cain and Seal (2018), section 4; JCGM 100:2008 (GUM), section 5.1.

    Args:
        photoelectrons: In e-; dark electrons taken off.
        quantum_efficiency: In e-/photon, above 0 and not above 1.

    Raises:
        InputError: `bad-quantum-efficiency`.
    """
    if not quantum_efficiency.is_known:
        return Estimate.unknown("photon", quantum_efficiency.reason)
    if not (0 < quantum_efficiency.value <= 1 and quantum_efficiency.std >= 0):
        raise InputError(
            f"a quantum efficiency of {quantum_efficiency.value:g} ± {quantum_efficiency.std:g} "
            "e-/photon: give one above 0 and not above 1, with its uncertainty.",
            code="bad-quantum-efficiency",
        )
    if not photoelectrons.is_known:
        return Estimate.unknown("photon", photoelectrons.reason)
    photons = photoelectrons.value / quantum_efficiency.value
    of_electrons = photoelectrons.std / quantum_efficiency.value
    of_efficiency = photons * quantum_efficiency.std / quantum_efficiency.value
    return Estimate(photons, hypot(of_electrons, of_efficiency), "photon")
