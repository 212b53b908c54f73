"""Without PyTorch the tests that need it are not collected; `make test-training`, which asks for them, then fails."""

from importlib.util import find_spec

_NEEDY = ["test_compare.py", "test_network.py", "test_loss.py", "test_thresholds.py", "test_train.py"]
collect_ignore = [] if find_spec("torch") else _NEEDY
