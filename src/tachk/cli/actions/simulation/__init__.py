"""`tachk simulate`: runs of a model are drawn, judged and written."""
