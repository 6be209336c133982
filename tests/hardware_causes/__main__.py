"""``python -m tests.hardware_causes``: see :mod:`tests.hardware_causes.study`."""

from tests.hardware_causes.study import main

if __name__ == "__main__":
    main()
