"""The official program of EMVA Standard 1288 finds in our images the parameters that our sensor was given."""
import numpy as np
import ours
import pytest

if not hasattr(np, "asfarray"):  # emva1288 1.0.2 was written for NumPy 1
    np.asfarray = lambda values: np.asarray(values, float)

from emva1288.process.data import Data1288  # noqa: E402
from emva1288.process.loader import LoadImageData  # noqa: E402
from emva1288.process.results import Results1288  # noqa: E402

WIDTH, HEIGHT = 320, 240
GIVEN = {"quantum_efficiency": 0.6, "system_gain_dn_per_e": 0.0275, "saturation_capacity_e": 9000.0,
         "dark_noise_e": 40.0, "dark_current_e_per_s": 20000.0, "prnu": 0.015, "dsnu_e": 60.0, "black_level_dn": 20.0}
SPATIAL_S = 0.02
PHOTONS_PER_S = 4.0e5
#: Electrons of light with which the largest number, 255, is reached: those of heat come on top.
SATURATED_E = ((255.0 - GIVEN["black_level_dn"]) / GIVEN["system_gain_dn_per_e"]
               / (1.0 + GIVEN["dark_current_e_per_s"] / (PHOTONS_PER_S * GIVEN["quantum_efficiency"])))


def _points():
    """(kind, exposure, photons, frames) of a measurement with steady light and variable exposure."""
    for exposure_s in np.linspace(0.001, 0.045, 45):
        for photons in (0.0, PHOTONS_PER_S * exposure_s):
            yield "temporal", float(exposure_s), photons, 2
    for photons in (0.0, PHOTONS_PER_S * SPATIAL_S):
        yield "spatial", SPATIAL_S, photons, 100


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    points = list(_points())
    file = tmp_path_factory.mktemp("emva") / "images.npz"
    ours.light(GIVEN, WIDTH, HEIGHT, file,
               [{"exposure_s": exposure_s, "photons": photons, "frames": frames, "seed": seed}
                for seed, (_, exposure_s, photons, frames) in enumerate(points)])
    stored = np.load(file)
    names = {"temporal": {}, "spatial": {}}
    shown = {}
    for index, (kind, exposure_s, photons, frames) in enumerate(points):
        series = stored[f"arr_{index}"]
        files = [f"{index}_{frame}" for frame in range(frames)]
        shown.update(zip(files, series))
        names[kind].setdefault(1e9 * exposure_s, {})[photons] = files  # nanoseconds, as the standard's files have them

    class FromMemory(LoadImageData):
        def _load_imgs(self, fnames):
            self._shape.add((HEIGHT, WIDTH))
            return [shown[name] for name in fnames]

    return Results1288(Data1288(FromMemory(names).data).data, loglevel=50)


# Each bound is what a measurement of this size leaves to chance, times three or more: K from variances of 76 800 pixels
# at 30 exposures (0.5 % each), sigma_d from one of them, the spatial ones from 76 800 pixels. Saturation is where the
# variance is largest, a few percent before the pixels are full, and in steps of 3 %.
@pytest.mark.parametrize("name, symbol, given, share", [
    ("system gain", "K", GIVEN["system_gain_dn_per_e"], 0.01),
    ("quantum efficiency", "QE", 100.0 * GIVEN["quantum_efficiency"], 0.01),
    ("dark noise", "sigma_d", GIVEN["dark_noise_e"], 0.05),
    ("saturation capacity", "u_e_sat", SATURATED_E, 0.08),
    ("dark current, from means", "u_I_mean", GIVEN["dark_current_e_per_s"], 0.01),
    ("dark current, from variances", "u_I_var", GIVEN["dark_current_e_per_s"], 0.1),
    ("DSNU", "DSNU1288", GIVEN["dsnu_e"], 0.02),
    ("PRNU", "PRNU1288", 100.0 * GIVEN["prnu"], 0.02),
])
def test_emva_finds_what_the_sensor_was_given(found, compared, name, symbol, given, share):
    compared(f"sensor, {name}", "emva1288 1.0.2", [abs(getattr(found, symbol) / given - 1.0)], share)


def test_emva_finds_the_line_straight(found, compared):
    compared("sensor, linearity", "emva1288 1.0.2", [abs(found.LE_min), abs(found.LE_max)], 0.5, "%")
