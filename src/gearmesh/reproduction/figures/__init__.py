"""Figures 1 to 7: functions from datasets and cases to matplotlib figures."""
