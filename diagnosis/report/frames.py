"""Tables for pandas, where it is installed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from twin.errors import UserError

if TYPE_CHECKING:
    import pandas as pd


def data_frame(rows: Sequence[Mapping[str, Any]], *, columns: Sequence[str]) -> pd.DataFrame:
    """Rows as a DataFrame: these columns first, whether a row has them or not, then further ones in their order.

    Raises UserError without pandas.
    """
    try:
        import pandas as pd
    except ImportError:
        raise UserError(
            "a DataFrame needs pandas; pip install '.[tables]' in the checkout, or take to_dict()"
        ) from None
    names = dict.fromkeys([*columns, *(name for row in rows for name in row)])
    return pd.DataFrame(list(rows), columns=list(names))
