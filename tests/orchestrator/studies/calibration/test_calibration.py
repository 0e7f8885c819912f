"""Fits: that a known parameter comes back, that the scenarios carry what the file says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import InputError, ScenarioError, SimulationError
from orchestrator.studies.calibration import calibrate, load_fits, profile, shipped
from orchestrator.studies.calibration.predictions import Model
from orchestrator.studies.calibration.table import data, facts, parameters, point_facts
from orchestrator.studies.paper.published_values import published_band

runner = CliRunner()

FIT = """
[[fits]]
name = "static"
[[fits.parameters]]
name = "force"
sets = "spring.blocked_force"
scenarios = ["oscillator-1"]
value = "0.1 N"
low = "0.01 N"
high = "1 N"
[[fits.data]]
name = "travel"
where = "made up"
scenario = "oscillator-1"
metric = "travel"
stop = "2 cycles"
set = { "amplifier.frequency" = "5 Hz", "spring.loss_factor" = 0.6 }
of = "value"
share = 0.5
value = "2 mm"
[[fits.data]]
name = "phase"
where = "made up"
scenario = "oscillator-1"
metric = "phase"
stop = "2 cycles"
set = { "amplifier.frequency" = "5 Hz", "spring.loss_factor" = 0.6 }
of = "value"
value = "0.06 rad"
held_out = true
"""


def written(folder: Path, text: str = FIT) -> Path:
    path = folder / "fits.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_force_comes_back(native: Path, tmp_path: Path) -> None:
    """Travel is in proportion to the force, and the phase does not know of it."""
    found = calibrate(load_fits(written(tmp_path))[0], native)
    assert found.errors[0] == pytest.approx(0.0, abs=1e-5)
    assert found.sensitivity[0, 0] == pytest.approx(1.0, abs=1e-3)
    assert abs(found.sensitivity[1, 0]) < 1e-2
    assert found.spread[0] == pytest.approx(0.01, rel=1e-2)
    assert found.fitted[0] == pytest.approx(0.1 * found.paper[0] / found.before[0], rel=1e-4)
    assert np.all(np.diag(found.correlation) == pytest.approx(1.0))
    assert parameters(found).row_count == 1
    assert data(found).row_count == 2
    assert facts(found)["data"]["phase"]["held_out"] is True


def test_the_scenes_carry_what_was_fitted(native: Path) -> None:
    """One set of parameters, no retuning hidden in a scenario."""
    for fit in load_fits(shipped()):
        if fit.experiment:
            continue
        model = Model(fit, native)
        for parameter, value in zip(fit.parameters, model.start, strict=True):
            assert model.carried(parameter) == pytest.approx([value] * len(parameter.scenarios))


def test_peaks_are_found_once_for_height_and_place(native: Path) -> None:
    fit = next(fit for fit in load_fits(shipped()) if fit.name == "oscillator")
    model = Model(fit, native)
    low, height, place = model.values(model.start)
    assert low == pytest.approx(2e-3, rel=0.01)
    assert height == pytest.approx(7.2e-3, rel=0.02)
    assert place == pytest.approx(52.0, rel=0.03)
    assert model.runs < 20


def test_a_range_without_a_peak_is_told(native: Path, tmp_path: Path) -> None:
    text = FIT.replace('of = "value"\nshare', 'of = "height"\nshare', 1)
    text = text.replace(
        'stop = "2 cycles"',
        'over = "amplifier.frequency"\nbetween = ["5 Hz", "9 Hz"]\nstop = "4 cycles"',
        1,
    )
    fit = load_fits(written(tmp_path, text))[0]
    with pytest.raises(SimulationError, match="travel: no peak between 5 and 9 Hz"):
        calibrate(fit, native, refit=False)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('of = "value"', 'of = "height"', "a peak needs over and between"),
        ("held_out = true", "held_out = 3", "held_out"),
        ('value = "2 mm"', 'value = "2 mm"\nheld_out = true', "1 parameters on 0 data"),
        ('value = "2 mm"', "", "value: is missing"),
        ("[[fits]]", "[[fist]]", "fits"),
        ("[[fits]]", "[[fits", "not TOML"),
    ],
)
def test_a_bad_file_is_refused(tmp_path: Path, old: str, new: str, reason: str) -> None:
    with pytest.raises(ScenarioError, match=reason):
        load_fits(written(tmp_path, FIT.replace(old, new, 1)))


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("spring.blocked_force", "spring.blocked_farce", "no parameter 'blocked_farce'; did you"),
        ('"0.1 N"', '"0.1 V"', "force: .*V"),
        ('metric = "travel"', 'metric = "travels"', "no metric 'travels'; did you mean 'travel'"),
        ('scenarios = ["oscillator-1"]', 'scenarios = ["oscillator-2"]', "no datum is of scenario"),
    ],
)
def test_what_the_scenes_do_not_have_is_told(
    native: Path, tmp_path: Path, old: str, new: str, reason: str
) -> None:
    fit = load_fits(written(tmp_path, FIT.replace(old, new, 1)))[0]
    with pytest.raises(InputError, match=reason):
        calibrate(fit, native, refit=False)


def test_the_command(native: Path, tmp_path: Path) -> None:
    options = ["--fits", str(written(tmp_path)), "--fmus", str(native), "--no-refit", "--json"]
    done = runner.invoke(app, ["calibrate", "static", *options])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)[0]["fit"] == "static"
    missing = runner.invoke(app, ["calibrate", "statics", *options])
    assert missing.exit_code == 2
    assert "did you mean 'static'" in missing.output


PROFILE = """
[fits.profile]
name = "share of the stiffness"
sets = "spring.stiffness"
scenarios = ["oscillator-1"]
value = "63.5 N/m"
shares = [1.0, 0.9, 0.7]
"""


def with_profile(folder: Path) -> Path:
    return written(folder, FIT.replace('name = "static"\n', f'name = "static"\n{PROFILE}'))


def test_a_profile_fits_at_each_share(native: Path, tmp_path: Path) -> None:
    """A softer spring goes as far with less force, very nearly in proportion below resonance."""
    fit = load_fits(with_profile(tmp_path))[0]
    found = profile(fit, native)
    assert [point.share for point in found] == [1.0, 0.9, 0.7]
    for point in found:
        assert point.data[0] == pytest.approx(2e-3, rel=2e-4)
        assert point.parameters[0] / found[0].parameters[0] == pytest.approx(point.share, rel=0.02)
    told = point_facts(fit, found)
    assert told["shares"] == [1.0, 0.9, 0.7]
    assert len(told["data"]["phase"]) == 3


def test_a_profile_where_there_is_none_is_told(native: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="static: has no profile"):
        profile(load_fits(written(tmp_path))[0], native)


def test_the_command_for_a_profile(native: Path, tmp_path: Path) -> None:
    options = ["--fits", str(with_profile(tmp_path)), "--fmus", str(native), "--profile"]
    done = runner.invoke(app, ["calibrate", "static", *options, "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)[0]["profile"] == "share of the stiffness"
    assert "share" in runner.invoke(app, ["calibrate", "static", *options]).output


def test_a_datum_that_no_one_measured_has_no_error(native: Path, tmp_path: Path) -> None:
    text = FIT.replace('value = "0.06 rad"\n', "")
    found = calibrate(load_fits(written(tmp_path, text))[0], native, refit=False)
    told = facts(found)["data"]["phase"]
    assert (told["paper"], told["error"]) == (None, None)
    assert told["ours"] > 0.0


def test_a_predicted_datum_has_a_band(native: Path, tmp_path: Path) -> None:
    """Travel and its own half: what the first is uncertain, relative, the second is too."""
    half = FIT.replace('metric = "phase"', 'metric = "travel"').replace('"0.06 rad"', '"4 mm"')
    text = half.replace('value = "2 mm"', 'value = "2 mm"\nuncertainty = "0.1 mm"')
    found = calibrate(load_fits(written(tmp_path, text))[0], native, refit=False)
    assert found.band[1] == pytest.approx(0.05, rel=1e-2)
    assert facts(found)["data"]["phase"]["band"] == pytest.approx(0.05, rel=1e-2)
    share = text.replace('"0.1 mm"', '"3 %"')
    found = calibrate(load_fits(written(tmp_path, share))[0], native, refit=False)
    assert found.band[1] == pytest.approx(0.03, rel=1e-2)
    with pytest.raises(InputError, match="travel: uncertainty"):
        calibrate(load_fits(written(tmp_path, text.replace("0.1 mm", "1 kg")))[0], native)


def test_a_ratio_is_to_another_datum(native: Path, tmp_path: Path) -> None:
    """Travel over itself is 1 whatever the force, so nothing of the force's band is left."""
    half = FIT.replace('metric = "phase"', 'metric = "travel"\nshare = 0.5\nagainst = "travel"')
    text = half.replace('"0.06 rad"', "2.0").replace('"2 mm"', '"2 mm"\nuncertainty = "0.1 mm"')
    found = calibrate(load_fits(written(tmp_path, text))[0], native, refit=False)
    assert found.after[1] == pytest.approx(1.0)
    assert found.errors[1] == pytest.approx(-0.5)
    assert found.band[1] == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(ScenarioError, match="against no datum 'travels'; did you mean 'travel'"):
        load_fits(written(tmp_path, text.replace('against = "travel"', 'against = "travels"')))


def test_what_the_fit_misses_widens_the_band(native: Path, tmp_path: Path) -> None:
    """Two data of one travel, 10 % apart: the mean of both misses each by 5 %, more than 1 %.

    s w = sqrt(2) 5 %, and the mean of two deviates by that over sqrt(2).
    """
    _, _, rest = FIT.partition("[[fits.data]]")
    datum, _, held_out = rest.partition("[[fits.data]]")
    data = [
        datum.replace("travel", name, 1).replace('"2 mm"', f'"{value} mm"\nuncertainty = "1 %"')
        for name, value in (("low", 1.9), ("high", 2.1))
    ]
    data = [each.replace('metric = "low"', 'metric = "travel"') for each in data]
    head = FIT.partition("[[fits.data]]")[0]
    text = "[[fits.data]]".join([head, *data, held_out])
    found = calibrate(load_fits(written(tmp_path, text))[0], native)
    assert found.scatter == pytest.approx(0.05 * np.sqrt(2.0), rel=0.05)
    assert found.band[0] == pytest.approx(0.05, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["vehicle", "material"])
def test_the_published_bands_are_those_of_the_fits(native: Path, name: str) -> None:
    (fit,) = load_fits(shipped(), [name])
    found = calibrate(fit, native, refit=False)
    keyed = [(d.key, float(b)) for d, b in zip(fit.data, found.band, strict=True) if d.key]
    assert len(keyed) > 5
    for key, band in keyed:
        assert published_band(key) == pytest.approx(band, rel=0.06), key


@pytest.mark.slow
def test_the_band_of_figure_11_is_that_of_sampled_vehicles(native: Path) -> None:
    """Two hundred vehicles, each for other data: the sixth number spreads by the linear band.

    The spread of two hundred is known to a twentieth; 1 Hz of 18 is beyond what is linear.
    """
    (fit,) = load_fits(shipped(), ["vehicle"])
    found = calibrate(fit, native, refit=False)
    at = next(k for k, d in enumerate(fit.data) if d.name == "peak with full wings, stroke")
    used = [not d.held_out for d in fit.data]
    scenario = fit.data[at].scenario
    mine = [k for k, p in enumerate(fit.parameters) if scenario in p.scenarios]
    parameters = [fit.parameters[k].model_copy(update={"scenarios": [scenario]}) for k in mine]
    alone = fit.model_copy(update={"data": [fit.data[at]], "parameters": parameters})
    model = Model(alone.model_copy(update={"profile": None}), native)
    draws = np.random.default_rng(7).normal(size=(200, sum(used))) * found.uncertainty[used]
    logs = [
        np.log(model.values((found.fitted * np.exp(found.gain @ draw))[mine].tolist())[0])
        for draw in draws
    ]
    assert np.std(logs) == pytest.approx(found.band[at], rel=0.25)


MISSED = {
    "2 layers, power": -0.13,
    "4 layers, power": 0.22,
    "4 layers, power over that of 2": 0.41,
    "6 layers, power": -0.16,
    "8 layers, power over that of 2": 0.12,
    "2 layers, stroke": -0.15,
}
"""What the film is off where nothing was fitted, as docs/reference/paper.md says."""


@pytest.mark.slow
def test_the_shipped_fits_hold(native: Path) -> None:
    """Fitted data to 1.2 %, or to twice what they are known to; those held out within 5 %."""
    for fit in load_fits(shipped()):
        found = calibrate(fit, native, refit=False)
        for datum, error in zip(fit.data, found.errors, strict=True):
            known = 2.0 * datum.within if datum.within < 1.0 else 0.012
            if datum.value is None or (fit.experiment and datum.held_out):
                continue
            if datum.name in MISSED:
                assert error == pytest.approx(MISSED[datum.name], abs=0.02), datum.name
            else:
                assert abs(error) < (0.05 if datum.held_out else known), datum.name
