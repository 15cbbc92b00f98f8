"""What examples/python has runs as it says, and so do its notebook and the stubs."""
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import snug

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples" / "python"
DEMONSTRATOR = ROOT / "scenarios" / "box-demonstrator.yaml"


def run(name, *words, cwd):
    environment = dict(os.environ, PYTHONPATH=str(Path(snug.__file__).parents[1]))
    environment.pop("DISPLAY", None)
    result = subprocess.run([sys.executable, EXAMPLES / name, *map(str, words)], cwd=cwd, env=environment,
                            capture_output=True, text=True, check=False, timeout=280)
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_simulate_and_plot(tmp_path):
    pytest.importorskip("matplotlib")
    run("01_simulate_and_plot.py", ROOT / "scenarios" / "drop.yaml", "heights.png", cwd=tmp_path)
    assert (tmp_path / "heights.png").read_bytes().startswith(b"\x89PNG")


def test_examples_run_without_words(tmp_path):
    assert "% of the container" in run("02_pack_and_report.py", cwd=tmp_path)
    assert "executed_boxes" in run("03_agent.py", cwd=tmp_path)
    assert "on average" in run("04_environment.py", cwd=tmp_path)


def test_pack_and_report(tmp_path):
    assert "% of the container" in run("02_pack_and_report.py", DEMONSTRATOR, "1", "run.html", cwd=tmp_path)
    assert (tmp_path / "run.html").stat().st_size > 100_000


def test_agent():
    sys.path.insert(0, str(EXAMPLES))
    try:
        agent = __import__("03_agent").Lowest()
    finally:
        sys.path.pop(0)
    result = snug.pack(snug.load_scenario(DEMONSTRATOR), "1", agent=agent, samples=0, robot="none")
    assert result.executed_boxes >= 5


def test_what_is_learnt_from_is_the_same_in_the_environment_and_for_the_agent():
    """The policy learns from arrays of the environment and acts on what an agent is told."""
    sys.path.insert(0, str(EXAMPLES))
    try:
        learn = __import__("05_learn")
    finally:
        sys.path.pop(0)
    env = snug.env.Packing(snug.load_scenario(DEMONSTRATOR), sequence="1", observation="boxes")
    observation, _ = env.reset(seed=1)
    for _ in range(3):
        observation, *_ = env.step(0)
    count, size = int(observation["action_mask"].sum()), env.scenario.container["inner_size"]
    places, boxes = observation["candidates"][:count], observation["boxes"][observation["boxes"][:, 6] > 0]
    seen = learn.features(places[:, :3], places[:, 3:6], places[:, 6], observation["item"], size, boxes)
    assert seen.shape == (count, learn.FEATURES) and seen.dtype == "float32" and len(boxes) == 3
    assert (abs(seen) <= 10).all() and (seen[:, 6:8] > -1e-3).all()  # within the walls
    told = learn.features(*(places[:, part].astype(float).tolist() for part in (slice(3), slice(3, 6), 6)),
                          observation["item"][:4].tolist(), list(size), boxes[:, :6].tolist())
    assert (abs(told - seen) < 1e-6).all()


def test_the_learnt_agent_packs(tmp_path, monkeypatch):
    pytest.importorskip("sb3_contrib")
    run("05_learn.py", "256", "learnt.zip", "2", cwd=tmp_path)
    monkeypatch.setenv("SNUG_LEARNT", str(tmp_path / "learnt.zip"))
    sys.path.insert(0, str(EXAMPLES))
    try:
        agent = __import__("05_learn").Learnt()
    finally:
        sys.path.pop(0)
    assert snug.pack(snug.load_scenario(DEMONSTRATOR), "1", agent=agent, samples=0, robot="none").executed_boxes > 0


@pytest.mark.parametrize("name", ["01_simulate_and_plot.py", "02_pack_and_report.py"])
def test_examples_are_ten_lines(name):
    lines = [line for line in (EXAMPLES / name).read_text().splitlines()[1:]
             if line.strip() and not line.startswith(("import", "from"))]
    assert len(lines) <= 10, name


def test_the_notebook_shows_the_report(monkeypatch):
    monkeypatch.chdir(ROOT)
    notebook = json.loads((EXAMPLES / "report.ipynb").read_text())
    names, shown = {}, []
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        *lines, last = "".join(cell["source"]).splitlines()
        exec("\n".join(lines), names)  # pylint: disable=exec-used
        shown.append(eval(last, names))  # pylint: disable=eval-used
    assert shown[0][0] >= 5
    assert "<iframe srcdoc=" in shown[1]._repr_html_()
    assert shown[2][0] > 0


def test_stubs_are_what_the_module_has():
    """Every public name of the compiled module is in its stub, and the other way round."""
    import ast

    from snug import _core

    stub = ast.parse((Path(snug.__file__).with_name("_core.pyi")).read_text())
    declared = {node.name: node for node in stub.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    assert set(declared) == {name for name in vars(_core) if not name.startswith("_")}
    for name, node in declared.items():
        if isinstance(node, ast.ClassDef):
            members = {part.name for part in node.body if isinstance(part, ast.FunctionDef)} - {"__init__", "__len__", "__eq__"}
            real = {member for member in vars(getattr(_core, name)) if not member.startswith("_")}
            assert members == real, name


def test_mypy_is_content(tmp_path):
    pytest.importorskip("mypy")
    source = tmp_path / "user.py"
    source.write_text("import snug\n"
                      "world = snug.World(snug.load_scenario('a.yaml'))\n"
                      "world.step(3)\n"
                      "height: float = world.pose('box')[2]\n"
                      "result = snug.pack(world.scenario, '1', samples=0)\n"
                      "env = snug.env.Packing(world.scenario, mode='executed')\n")
    environment = dict(os.environ, MYPYPATH=str(ROOT / "python"))
    result = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", tmp_path, source, ROOT / "python" / "snug"],
                            env=environment, capture_output=True, text=True, check=False, timeout=280)
    assert result.returncode == 0, result.stdout + result.stderr
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import snug\nsnug.World(3)\nsnug.load_scenario('a').no_such_name\n")
    result = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", tmp_path, wrong], env=environment,
                            capture_output=True, text=True, check=False, timeout=280)
    assert "Found 2 errors" in result.stdout
