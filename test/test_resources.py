import pytest

from impact_predictor import resources
from impact_predictor.errors import InputError


def test_a_shipped_file_is_found_in_the_source_tree():
    assert resources.find("config/cube_tosses.yaml").is_file()
    assert (resources.find("examples/cube_tosses") / "metadata.yaml").is_file()


@pytest.mark.parametrize("library", ["lib/python3.12/site-packages", "lib/python3/dist-packages"])
def test_an_installed_file_is_found_under_share_beside_the_library(monkeypatch, tmp_path, library):
    module = tmp_path / library / "impact_predictor/resources.py"
    shipped = tmp_path / "share/impact_predictor/config/scene.yaml"
    for file in (module, shipped):
        file.parent.mkdir(parents=True)
        file.touch()
    monkeypatch.setattr(resources, "__file__", str(module))
    assert resources.find("config/scene.yaml") == shipped


def test_a_file_of_a_colcon_workspace_is_found_through_the_ament_prefix_path(monkeypatch, tmp_path):
    shipped = tmp_path / "share/impact_predictor/config/scene.yaml"
    shipped.parent.mkdir(parents=True)
    shipped.touch()
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"/nowhere:{tmp_path}")
    assert resources.find("config/scene.yaml") == shipped


def test_a_file_that_is_nowhere_is_one_sentence_that_says_what_to_do():
    with pytest.raises(InputError, match=r"config/nothing\.yaml is not installed; install the package"):
        resources.find("config/nothing.yaml")
