"""The answer of `Model.synthesize`: a region that can be written in every form."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tachk.base.whole_files import whole_bytes
from tachk.meaning.judge.certificate import CertificateWriter
from tachk.report.json_report import Json
from tachk.report.region.json import Row, region_to_json, row_of
from tachk.report.region.text import region_text
from tachk.report.region.words import assignment, inequalities, summary
from tachk.verify.synthesis.region import Region, RegionCell
from tachk.verify.verdict import Answer


@dataclass(frozen=True, slots=True)
class Synthesis:
    """For which values of constants a property holds.

    Attributes:
        region: every combination of values with its answer and the evidence for it.
        time_unit: of the model.
    """

    region: Region
    time_unit: str = ""

    @property
    def inequalities(self) -> str:
        """Linear inequalities that agree with all decided cells: ``WRITE <= WAIT``; empty where none were found."""
        return inequalities(self.region)

    @property
    def corners(self) -> tuple[RegionCell, ...]:
        """The cells where the border turns, each with a run or with a search that explored everything."""
        return self.region.corners

    def at(self, **values: int) -> RegionCell:
        """The cell with these values. Raises KeyError if it is none of the region."""
        return self.region.at(**values)

    def answer(self, **values: int) -> Answer:
        """The answer with these values. Raises KeyError if they are not in the region."""
        return self.at(**values).answer

    def to_dict(self) -> dict[str, Json]:
        """The region as docs/schema/synthesize.schema.json describes it."""
        return region_to_json(self.region)

    def to_rows(self) -> list[Row]:
        """One flat dictionary for each cell: what `pandas.DataFrame` takes."""
        return [row_of(self.region, cell) for cell in self.region.cells]

    def to_text(self, every_corner: bool = False) -> str:
        """What `tachk synthesize` prints."""
        return region_text(self.region, self.time_unit, every_corner)

    def certificates(self, folder: str | Path) -> list[Path]:
        """Writes the certificate of each corner that has one into a file of its own and returns their paths.

        The names are those of the values, such as ``WRITE=2,WAIT=2.cert``; `tachk certify` checks each with the same
        values of the constants.
        """
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        written = []
        for cell in self.corners:
            if cell.certificate is not None:
                path = target / f"{assignment(self.region, cell).replace(' ', ',')}.cert"
                with whole_bytes(path) as stream:
                    CertificateWriter(stream).write(cell.certificate.header, cell.certificate.blocks())
                written.append(path)
        return written

    def plot(self, path: str | Path) -> None:
        """Draws the region. Raises UsageError if the path does not end in .svg, .png or .pdf."""
        from tachk.report.region.picture import plot_region

        plot_region(self.region, path)

    def __str__(self) -> str:
        return self.to_text()

    def __repr__(self) -> str:
        return f"<Synthesis on {self.region.model}: {summary(self.region)}>"
