"""The notebooks of the documentation run, cell by cell, and every picture in them is there."""

import os
from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")

FOLDER = Path(__file__).parents[3] / "docs" / "notebooks"
NEEDS = {"06-mesh": ["trimesh"], "10-farm": ["distributed"]}
PLOTS = ["02-parameter-sweep", "03-convergence", "04-prism", "07-layers"]
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def test_there_are_ten():
    assert len(NOTEBOOKS) == 10


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_runs(path, tmp_path):
    needs = NEEDS.get(path.stem, []) + (["matplotlib"] if path.stem in PLOTS else [])
    for module in needs:
        pytest.importorskip(module)
    if path.stem == "10-farm" and "KAJO_PROGRAM" not in os.environ:
        pytest.skip("the program kajo is not there")
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    written = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in written), "it is kept without outputs"
    resources = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3", resources=resources).execute()
    outputs = [output for cell in written for output in cell.outputs]
    pictures = [output for output in outputs if "image/png" in output.get("data", {})]
    assert pictures, [output.get("text", "")[-500:] for output in outputs]
    if "KAJO_NOTEBOOK_PICTURES" in os.environ:
        import base64

        for i, picture in enumerate(pictures):
            png = base64.b64decode(picture["data"]["image/png"])
            Path(os.environ["KAJO_NOTEBOOK_PICTURES"], f"{path.stem}-{i}.png").write_bytes(png)
