"""The live page in a real browser: its controls are moved, and what the servo did is read."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from browser import CHROMIUM, Browser, end

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
PROGRAM = Path(__file__).resolve().parents[4] / "aras_visual_servo" / "scripts" / "aras-servo"
READY = "document.body.classList.contains('ready') && aras.model.state && aras.model.image"
LIMIT_S = 60.0


@pytest.fixture
def serve():
    """Function that starts `live` with these arguments and gives the page's address."""
    processes = []

    def start(*arguments):
        process = subprocess.Popen([sys.executable, str(PROGRAM), "live", "experiment_1", "--port", "0", *arguments],
                                   stdout=subprocess.PIPE, text=True)
        processes.append(process)
        return process.stdout.readline().split()[-1]

    yield start
    for process in processes:
        end(process)


def status(browser):
    return browser.value("aras.model.state.status")


def slide(browser, path, share):
    """Drag the slider of a setting to a share of its way, as a hand does; gives the value that it shows."""
    box = browser.value(f"(() => {{ const e = document.querySelector('[data-path=\"{path}\"] input[type=range]'); "
                        "e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect(); "
                        "return [b.x, b.y, b.width, b.height, Number(e.value)]; })()")
    x, y, width, height, at = box
    browser.drag((x + 8 + at * (width - 16), y + height / 2), (x + 8 + share * (width - 16), y + height / 2), steps=4)
    return browser.value(f"Number(document.querySelector('[data-path=\"{path}\"] input[type=number]').value)")


def test_a_gain_that_is_moved_while_it_servoes_acts_at_once(serve, tmp_path):
    with Browser(tmp_path) as browser:
        browser.open(serve("--speed", "0.1", "--set", "servo.gains_per_s.xn=0.5"))
        browser.wait(READY)
        browser.value("aras.ask({do: 'speed', factor: 2}).then(() => 1)")
        browser.wait("aras.model.state.phase === 'servo'", 2 * LIMIT_S)
        browser.value("aras.ask({do: 'speed', factor: 0.1}).then(() => 1)")
        gain = slide(browser, "servo.gains_per_s.xn", 0.45)
        browser.wait(f"aras.model.values.servo.gains_per_s.xn === {gain}")
        assert gain > 1.9
        t0 = browser.value("aras.model.state.t")
        browser.wait(f"aras.model.state.t > {t0} + 0.4")
        rows = browser.value("aras.model.rows.map((row) => [row[0], row[aras.model.column['e.xn']]])")
        t, e = np.array(rows, dtype=float).T
        after = (t > t0 + 0.1) & (t < t0 + 0.3)
        found = -np.polyfit(t[after], np.log(np.abs(e[after])), 1)[0]
        assert found == pytest.approx(gain, rel=0.25)
        assert browser.said == []


def test_a_setting_shows_what_was_asked_for_until_the_run_has_answered(serve, tmp_path):
    path = "servo.gains_per_s.xn"
    shown = f"Number(document.querySelector('[data-path=\"{path}\"] input[type=number]').value)"
    with Browser(tmp_path) as browser:
        browser.open(serve())
        browser.wait(READY)
        browser.value("window.held = []; const ask = aras.ask.bind(aras); aras.ask = (request) => request.do !== 'set' "
                      "? ask(request) : new Promise((answer) => held.push({ request, answer })); 1")
        slide(browser, path, 0.9)
        browser.wait("held.length === 1")
        asked = slide(browser, path, 0.75)  # a second drag: a busy browser may report the whole of one as one event

        def told(value):
            return browser.value(f"aras.model.values_are({{'{path}': {value}}}, aras.model.waiting); {shown}")

        assert told(0.6) == asked  # an older value of the same drag: the run is behind the hand
        browser.value("held[0].answer({}); 1")
        browser.wait("held.length === 2")
        assert browser.value(f"held[1].request.values['{path}']") == asked
        assert told(0.8) == asked
        told(asked)
        browser.value("held[1].answer({}); 1")
        browser.wait(f"aras.model.values.servo.gains_per_s.xn === {asked} && {shown} === {asked}")
        assert told(1.25) == 1.25  # another page's
        assert browser.said == []


def on_screen(browser, *ways_m):
    """Where the places so far beside the target, along y, are on the screen: [[x, y], ...] in px."""
    return browser.value(
        "(() => { const w = aras.world, b = w.canvas.getBoundingClientRect(); w.eye.updateMatrixWorld(); "
        f"return {list(ways_m)}.map((d) => {{ const p = w.target.position.clone(); p.y += d; p.project(w.eye); "
        "return [b.x + (p.x + 1) / 2 * b.width, b.y + (1 - p.y) / 2 * b.height]; }); })()")


def test_the_target_is_dragged_in_the_view_and_the_arm_follows(serve, tmp_path):
    with Browser(tmp_path, webgl=True) as browser:
        browser.open(serve("--speed", "4"))
        browser.wait(READY + " && aras.world")
        browser.wait("aras.model.state.status === 'CONVERGED'")
        camera, target = browser.value("[aras.model.state.camera, aras.model.state.target]")
        browser.wait("aras.world.reach")
        assert browser.value("aras.world.plane.visible") is False
        begin, end_at = on_screen(browser, 0, 0.05)
        browser.drag(begin, end_at, release=False)
        assert browser.value("aras.world.plane.visible") is True
        browser.mouse("mouseReleased", end_at)
        assert browser.value("aras.world.plane.visible") is False
        # On a busy machine the arm is home between two steps of the drag: only the last one counts.
        there = [f"Math.abs(aras.model.state.{what}[1] - {before[1] + 0.05}) < 5e-3"
                 for what, before in (("target", target), ("camera", camera))]
        browser.wait(" && ".join(["aras.model.state.status === 'CONVERGED'", *there]))
        after_camera, after_target = browser.value("[aras.model.state.camera, aras.model.state.target]")
        moved = np.subtract(after_target[:3], target[:3])
        # A pixel of the view is some 2 mm there.
        assert moved == pytest.approx([0.0, 0.05, 0.0], abs=4e-3) and moved[2] == pytest.approx(0.0, abs=1e-6)
        assert np.subtract(after_camera[:3], camera[:3]) == pytest.approx(moved, abs=1e-3)
        assert browser.said == []


def test_a_drag_is_not_lost_in_the_moment_in_which_the_view_is_made_plainer(serve, tmp_path):
    moved = "aras.world.target.position.y - aras.model.about.scene.models[0].pose[1]"
    with Browser(tmp_path, webgl=True) as browser:
        browser.open(serve("--idle"))
        browser.wait(READY + " && aras.world?.drawn")
        begin, middle, end = on_screen(browser, 0, 0.03, 0.05)
        browser.value("window.asked = []; const ask = aras.ask.bind(aras); "
                      "aras.ask = (request) => { asked.push(request); return ask(request); }; 1")
        browser.drag(begin, begin, steps=1)  # a click places nothing: a target that moves would stop there
        browser.drag(begin, begin, steps=1, release=False)
        assert browser.value("asked") == []
        # The eighth picture in turn that took long, and a pointer that moves before the next one is drawn.
        assert browser.value(
            "(() => { const w = aras.world, drawn = performance.now() - 100; "
            "Object.assign(w, { plain: 1, slow: 7, drawn, dirty: true }); w.draw(); "
            f"const at = {{ clientX: {middle[0]}, clientY: {middle[1]} }}; "
            "w.canvas.dispatchEvent(new PointerEvent('pointermove', at)); return w.plain; })()") == 2
        assert browser.value(moved) == pytest.approx(0.03, abs=1e-3)
        browser.wait("aras.world.canvas.width === Math.floor(0.6 * aras.world.canvas.clientWidth)")
        browser.mouse("mouseReleased", end)  # where it is let go counts, though no move led there
        browser.wait(f"Math.abs({moved} - 0.05) < 1e-3 && Math.abs(aras.model.state.target[1] - "
                     "aras.world.target.position.y) < 1e-5")
        assert browser.said == []


def test_a_page_that_is_reloaded_goes_on_where_the_run_is(serve, tmp_path):
    # A run that began before the browser is there, or that converges while the page is slow, would be over too early.
    address = serve("--idle", "--set", "servo.hold_s=300", "--set", "servo.time_limit_s=600")
    with Browser(tmp_path) as browser:
        browser.open(address)
        browser.wait(READY)
        browser.click("#start")
        browser.wait("aras.model.state.status === 'SERVOING'")
        t = browser.value("aras.model.state.t")
        browser.call("Page.reload")
        browser.wait(f"{READY} && aras.model.state.t > {t} && aras.model.rows[0][0] < {t} && aras.model.goal")
        # A page that is told of another law still has the goal.
        browser.value("aras.ask({do: 'set', values: {'servo.law': 'ibvs'}}).then(() => 1)")
        browser.wait("aras.model.about.values.servo.law === 'ibvs' && aras.model.goal")
        with Browser(tmp_path / "second") as second:
            second.open(address)
            second.wait(READY + " && aras.model.viewers === 2")
            second.click("#stop")
            browser.wait("aras.model.state.phase === 'done'")
        browser.wait("aras.model.viewers === 1")
        assert browser.said == []


def test_the_buttons_pause_step_reset_and_start(serve, tmp_path):
    with Browser(tmp_path) as browser:
        browser.open(serve("--idle"))
        browser.wait(READY)
        browser.click("#pause")
        browser.wait("aras.model.state.paused")
        frame = browser.value("aras.model.state.frame")
        browser.click("#step")
        browser.wait(f"aras.model.state.frame === {frame} + 1")
        browser.click("#pause")
        browser.wait(f"aras.model.state.frame > {frame} + 5")
        browser.click("#start")
        browser.wait("aras.model.state.phase !== 'idle'")
        browser.click("#stop")
        browser.wait("aras.model.state.phase === 'done'")
        browser.click("#reset")
        browser.wait("aras.model.state.phase === 'idle' && aras.model.state.t < 5")
        browser.value("document.querySelector('#save').closest('details').open = true")
        browser.click("#save")
        assert "servo:" in browser.wait("aras.saved")
        assert browser.said == []


def test_words_units_and_laws_that_need_other_features(serve, tmp_path):
    def change(path, tag, value):
        browser.value(f"(() => {{ const one = document.querySelector('[data-path=\"{path}\"] {tag}'); "
                      f"one.value = '{value}'; one.dispatchEvent(new Event('change')); return 1; }})()")

    def write(before, after):
        browser.value("(() => { const one = document.querySelector('#law-text'); one.value = one.value.replace("
                      f"'{before}', '{after}'); one.dispatchEvent(new Event('input')); return 1; }})()")
        browser.click("#law-apply")

    with Browser(tmp_path) as browser:
        browser.open(serve("--idle", "--edit"))
        browser.wait(READY)
        browser.value("document.querySelector('#law-text').closest('details').open = true")
        # A law that is written here: its fault leads to its line, and the law of a good text is used.
        write("look.view", "look.view(")
        told = "document.querySelector('#law-told').dataset.is"
        browser.wait(f"{told} === 'refused'")
        browser.click(f"[data-line='{browser.wait('document.querySelector(`[data-line]`)?.dataset.line')}']")
        assert browser.value("(() => { const one = document.querySelector('#law-text'); return one === "
                             "document.activeElement && one.getAttribute('aria-invalid') === 'true' && "
                             "one.value.slice(one.selectionStart, one.selectionEnd); })()").endswith("look.view()")
        write("look.view(", "look.view(1")
        browser.value("document.querySelector('#law-text').dispatchEvent(new Event('input'))")
        assert browser.value(told) == "edited"
        write("look.view(1", "look.view")
        browser.wait("aras.model.values.servo.law === 'mine' && !document.querySelector('[data-line]')")
        browser.wait(f"{told} === 'used'")
        browser.value("aras.ask({do: 'set', values: {'servo.law': 'decoupled'}}).then(() => 1)")
        # Millimetres and degrees beside the curves' own; the run is asked in metres.
        shown = "Number(document.querySelector('[data-path=\"servo.thresholds.xn\"] input[type=number]').value)"
        assert browser.value(shown) == pytest.approx(0.05)
        change("servo.thresholds.xn", "input[type=number]", "0.08")
        browser.wait("aras.model.values.servo.thresholds.xn === 8e-5")
        # A slider of factors keeps its range, and its thumb stays where it was put.
        places = [slide(browser, "servo.gains_per_s.yn", share) for share in (1.0, 0.5, 0.0, 0.5)]
        assert places[0] > 30.0 * places[1] > 900.0 * places[2] and places[1] == places[3]
        browser.wait(f"aras.model.values.servo.gains_per_s.yn === {places[3]}")
        shared = "document.querySelector('[data-path=\"servo.gains_per_s\"] input[type=number]').value"
        assert browser.value(shared) == ""
        every = slide(browser, "servo.gains_per_s", 0.4)
        browser.wait(f"Object.values(aras.model.values.servo.gains_per_s).every((one) => one === {every})")
        change("servo.features", "input", "xn, yn, an, alfa")
        browser.click(".hints [data-name=alpha]")
        browser.wait("String(aras.model.values.servo.features) === 'xn,yn,an,alpha'")
        change("servo.law", "select", "pbvs")
        browser.wait("document.querySelector('#take-offer')")
        assert browser.value("aras.model.values.servo.law") == "decoupled"
        browser.click("#take-offer")
        browser.wait("aras.model.values.servo.law === 'pbvs' && aras.model.about.features.length === 6")
        assert browser.said == []


def test_time_goes_back_and_two_runs_lie_over_one_another(serve, tmp_path):
    with Browser(tmp_path) as browser:
        browser.open(serve("--idle", "--speed", "8"))
        browser.wait(READY)
        browser.click("#start")
        browser.wait("aras.shared.run?.ended && aras.runs.all.length === 1")
        # The curves hold the servo, with its moments.
        began, converged = browser.value("aras.shared.run.marks.filter((one) => ['began', 'CONVERGED']"
                                         ".includes(one.kind)).map((one) => one.t)")
        assert browser.value("aras.charts.map((one) => [one.from, one.to])") == [[began, converged]] * 6
        gains = {f"servo.gains_per_s.{name}": 6.0 for name in ("xn", "yn", "an", "alpha")}
        browser.value(f"aras.ask({{do: 'set', values: {gains}}}).then(() => 1)")
        browser.click("#again")
        browser.wait("aras.runs.all.length === 2 && aras.shared.run?.ended")
        browser.value("(() => { const over = document.querySelector('#over'); over.value = '1'; "
                      "over.dispatchEvent(new Event('change')); return 1; })()")
        browser.wait("aras.charts[0].others().length === 4")
        shift = browser.value("aras.charts[0].others()[0].shift")
        assert began + shift == pytest.approx(browser.value("aras.runs.all[1].from"))
        # Back to a moment: slider, curves, view and image show the same one.
        browser.click("#time")
        browser.wait("aras.model.past && aras.shared.at === aras.model.past.t")
        at, end_t = browser.value("[aras.shared.at, aras.shared.run.to]")
        caption = browser.value("document.querySelector('.camera figcaption').innerText")
        assert began < at < end_t and f"{at - browser.value('aras.shared.run.from'):.2f}" in caption
        browser.value("window.shown = []; aras.model.on('shown', (state) => shown.push(state)); "
                      "document.querySelector('[data-kind=began]').click(); 1")
        q, first = browser.value("[shown[0].q, aras.model.past.rows[0].slice(11, 17)]")
        assert len(q) == 6 and q == first
        browser.value("aras.model.on('picture', (one) => { window.picture = one; }); "
                      "document.querySelector('[data-kind=CONVERGED]').click(); 1")
        browser.wait("!aras.model.fetching && picture")
        # Of the last image, or of one before it where the page was too slow to be sent that one.
        seen = browser.value("aras.model.past.rows.map((row) => ['u', 'v', 't'].map((name) => "
                             "row[aras.model.past.column[name]]))")
        marks = browser.value("picture.marks.centre")
        assert min(t for u, v, t in seen if abs(u - marks[0]) + abs(v - marks[1]) < 1.0) > began
        # A click on a curve goes there too, and a new servo returns to what is now.
        box = browser.value("(() => { const b = aras.charts[0].canvas; b.scrollIntoView({block: 'center'}); const c = "
                            "b.getBoundingClientRect(); return [c.x + 0.4 * c.width, c.y + 40, 0.4 * c.width]; })()")
        browser.drag(box[:2], box[:2], steps=1)
        there = browser.value("((c, x) => c.from + (x - 54) / (c.w - 64) * (c.to - c.from))(aras.charts[0], "
                              f"{box[2]})")
        browser.wait(f"Math.abs(aras.shared.at - {there}) < 0.02")
        # Runs are named by what differs between them, and by law and gain.
        names = browser.value("aras.runs.all.map((run) => aras.runs.words(run))")
        assert names == ["decoupled, gain 3", "decoupled, gain 6"]
        whole = browser.value("aras.runs.all.map((run) => aras.runs.name(run))")
        assert all(re.fullmatch(rf"run {i + 1}: converged \d\.\d s, {names[i]}", whole[i]) for i in (0, 1))
        # A status is not told of an arm that was moved since.
        assert browser.value("document.querySelector('#status').dataset.status") == "CONVERGED"
        browser.value("(() => { const i = 4, q = aras.model.state.q[i]; return aras.ask({do: 'joint', name: "
                      "aras.model.about.joints[i].name, position: q + (q > 0 ? -0.3 : 0.3)}).then(() => 1); })()")
        browser.wait("document.querySelector('#status').dataset.status === 'IDLE'")
        assert "un 2: " in browser.value("document.querySelector('#text').textContent")
        e_now = "Math.abs(aras.model.rows.at(-1)[aras.model.column['e.alpha']])"
        browser.wait(f"{e_now} > 0.1 && aras.model.rows.at(-1)[aras.model.column.status] === 0")
        browser.click("#live-now")
        browser.wait("!aras.model.past")
        browser.click("#reset")
        browser.wait("aras.model.state.phase === 'idle' && aras.runs.all.length === 2")
        assert browser.said == []


def test_a_lesson_is_set_and_its_answer_checked(serve, tmp_path):
    with Browser(tmp_path) as browser:
        browser.open(serve("--idle", "--speed", "0"))
        browser.wait(READY)
        browser.value("(() => { document.querySelector('#lesson').closest('details').open = true; "
                      "document.querySelector('#lesson').value = 'singularity'; return 1; })()")
        browser.click("#lesson-set")
        browser.wait("aras.model.state.lesson?.ready && document.querySelector('#lesson-change')")
        assert browser.value("document.querySelector('#lesson-try').disabled")
        browser.value("document.querySelector('#lesson-change').selectedIndex = 2")
        browser.click(".lesson input[value=slower]")
        browser.click("#lesson-try")
        browser.wait("aras.model.state.lesson.right === false")
        assert browser.value("document.querySelector('#lesson-told').dataset.right") == "false"
        browser.click("#lesson-leave")
        browser.wait("!aras.model.state.lesson && !document.querySelector('#lesson-change')")
        assert browser.said == []


def test_without_webgl_the_page_says_so_and_keeps_the_rest(serve, tmp_path):
    with Browser(tmp_path) as browser:
        browser.open(serve())
        browser.wait(READY + " && aras.model.rows.length > 20")
        assert "no WebGL" in browser.value("document.querySelector('#no-webgl').textContent")
        canvases = "[...document.querySelectorAll('#live, .chart canvas')]"
        browser.wait(f"{canvases}.length >= 7 && {canvases}.every((one) => one.width > 100 && "
                     "one.getContext('2d').getImageData(0, 0, one.width, one.height).data.some((x) => x))")
        browser.click("#stop")
        browser.wait("aras.model.state.phase === 'done'")


def test_the_page_fits_its_width_and_everything_can_be_read(serve, tmp_path):
    address = serve()
    with Browser(tmp_path, webgl=True) as browser:
        for width, dark in ((390, False), (1024, True), (1280, False), (1440, True)):
            browser.open("about:blank")
            browser.look((width, 844), dark)
            browser.open(address)
            browser.wait(READY + " && aras.world?.drawn && aras.model.rows.length > 5")
            fits_and_can_be_read(browser, dark)


def fits_and_can_be_read(browser, dark):
    assert browser.value("document.documentElement.scrollWidth <= innerWidth")
    assert browser.value("[...document.querySelectorAll('.card')].every((one) => one.getBoundingClientRect().right "
                         "<= innerWidth)")
    assert browser.value("[...document.querySelectorAll('.chart')].length") == 6
    # The arm is seen as a whole, with camera and target.
    assert browser.value("aras.world.corners().length >= 40 && aras.world.corners().every((one) => { one.project(aras"
                         ".world.eye); return Math.abs(one.x) < 1 && Math.abs(one.y) < 1; })")
    # The longest reason is shown in full, and the status does not cover the clock.
    reason = "for the last 19.9 s the arm could not follow the law. " * 6
    told, cut, apart = browser.value(
        "(() => { aras.model.emit('state', {...aras.model.state, status: 'FAULT', phase: 'done', text: "
        f"'{reason}'}}); "
        "const all = [...document.querySelectorAll('#why, #why > p:not([role]), #status, #text')], "
        "[a, b] = ['#status', '.clock'].map((one) => document.querySelector(one).getBoundingClientRect()); "
        "return [document.querySelector('#text').innerText, all.some((one) => one.scrollWidth > one.clientWidth + 1 "
        "&& getComputedStyle(one).display !== 'inline'), a.right <= b.left || b.right <= a.left || "
        "a.bottom <= b.top || b.bottom <= a.top]; })()")
    assert told.lower().split() == reason.lower().split() and not cut and apart
    page, ink = browser.value("['backgroundColor', 'color'].map((key) => getComputedStyle(document.body)[key]"
                              ".match(/[0-9]+/g).map(Number).reduce((a, b) => a + b) / 3)")
    assert (page < 60 and ink > 180) if dark else (page > 200 and ink < 80)
    assert browser.said == []


LIMITS = """(() => {
  const { about, column } = aras.model, model = Object.create(aras.model);
  Object.assign(model, { listeners: new Map(), state: { t: 9, factor: 1 } });
  const runs = new aras.runs.constructor(model), joint = about.joints[1], row = (t, changes) => {
    const one = about.rows.map(() => 0);
    const servoing = { t, limited: null, status: about.statuses.indexOf('SERVOING') };
    for (const [name, value] of Object.entries({ ...servoing, ...changes }))
      one[column[name]] = value;
    return one;
  };
  [0, 9].forEach((image) => runs.told({ image, values: aras.model.values }));
  const at = (share) => ({ servo: 1, [`q.${joint.name}`]: share * (joint.upper - 0.01) });
  [row(1, at(0)), row(2, { ...at(0.9), status: about.statuses.indexOf('JOINT_LIMIT'), limited: 1 }), row(3, at(0.999)),
    row(4, at(1.001)), row(5, at(0.5)), row(6, at(-0.999)), row(7, { status: about.statuses.indexOf('TIMED_OUT') }),
    row(8, { status: about.statuses.indexOf('FAULT') }),
    ...[8.5, 9].map((t) => row(t, { status: about.statuses.indexOf('FAULT'), image: 9 }))]
    .forEach((one) => runs.take(one));
  return [joint.name, runs.all.map((run) => run.marks.map((mark) => [mark.label, mark.times]))];
})()"""


def test_joints_at_their_limits_refused_values_and_their_ends(serve, tmp_path):
    with Browser(tmp_path) as browser:
        browser.open(serve("--idle"))
        browser.wait(READY)
        # A joint is at its limit when it is there, whatever the status says; a servo that fails at once is a run.
        name, (marks, failed) = browser.value(LIMITS)
        assert [times for label, times in marks if label.startswith(f"{name}: ")] == [[2], [3, 6]]
        assert [times for _, times in failed] == [[8.5], [8.5]]
        # The slider of the latency ends where the check of the scenario does, also when that moves.
        browser.value("document.querySelectorAll('#controls details').forEach((one) => { one.open = true; }); 1")
        path = "sim.cameras.0.latency_s"
        assert slide(browser, path, 1.0) == 0.1646
        browser.wait("aras.model.values.sim.cameras[0].latency_s === 0.1646")
        browser.value("aras.ask({do: 'set', values: {'servo.input_timeout_s': 0.4}}).then(() => 1)")
        assert slide(browser, path, 1.0) == 0.3646
        assert slide(browser, "sim.cameras.0.noise_stddev", 1.0) == 100.0
        # What is refused is taken back, and nothing moves under the hand.
        gain = "document.querySelector('[data-path=\"servo.gains_per_s.xn\"] input[type=number]')"
        browser.value(f"(() => {{ const box = {gain}; window.box = box; box.scrollIntoView({{block: 'center'}}); "
                      "window.y = box.getBoundingClientRect().y; box.focus(); box.value = '-1'; "
                      "box.dispatchEvent(new Event('change')); return 1; })()")
        browser.wait("!document.querySelector('#notice').hidden && box.value === '3'")
        assert browser.value("document.activeElement === box && box.getBoundingClientRect().y === y")
        assert browser.said == []
