"""Without PyTorch the tests that need it are not collected; `make test-training`, which asks for them, then fails."""

from importlib.util import find_spec

collect_ignore = [] if find_spec("torch") else ["test_compare.py", "test_network.py", "test_loss.py", "test_train.py"]
