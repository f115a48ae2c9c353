"""`tachk simulate`: runs of a model are drawn, judged and written; models as units that others run."""
