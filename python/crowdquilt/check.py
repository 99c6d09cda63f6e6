"""The contract of a finished crowd, verified from its output alone."""

from crowdquilt._core import Report, Row, Summary, summary
from crowdquilt._core import check_crowd as check

__all__ = ["Report", "Row", "Summary", "check", "summary"]
