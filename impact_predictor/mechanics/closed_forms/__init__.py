"""The paper's closed forms: plastic impacts of a plate, a rod and a cylinder that turn about the old contact at rest.

`plate`, `rod` and `cylinder` take the arguments of the bodies of the same name, numbers or arrays that broadcast, and
the angular velocity before the impact. The modules `flat` and `cylindrical` have the formulas of each mode, the
domains in which the modes exist, and the borders between them (Fig. 5 and Fig. 7). What the paper misprints is given
as it must be; docs/errata.md derives it.

Counter-clockwise is positive; the paper counts its omega clockwise. Impulses act on the body along the normal and the
tangent of a contact, so that the paper's S_F is -T on a floor and T at the edges of a cylinder.
"""

from .cylindrical import cylinder
from .flat import ClosedForm, UnitImpact, plate, rod

__all__ = ["ClosedForm", "UnitImpact", "cylinder", "plate", "rod"]
