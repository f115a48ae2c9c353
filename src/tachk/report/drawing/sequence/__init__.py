"""Sequence charts: who sent what to whom, when, and what was lost.

`chart` is what is drawn, `layout` finds a place for everything, `sequence_svg` writes the picture.
"""
