"""Long studies run on request only here too."""

from tests.diagnosis.conftest import pytest_collection_modifyitems

__all__ = ["pytest_collection_modifyitems"]
