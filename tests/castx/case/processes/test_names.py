"""The names of casting processes are those of their files."""

from castx.case.processes.names import FOLDER, process_names


def test_each_file_is_a_process():
    assert list(process_names()) == sorted(process_names())
    for name in process_names():
        assert (FOLDER / f"{name}.toml").is_file()
    assert {"gravity-die", "sand", "investment"} < set(process_names())
