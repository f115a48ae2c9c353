"""The commands of `tachk xrce`, which are about packets of DDS-XRCE: one module each, as in the folder above."""
