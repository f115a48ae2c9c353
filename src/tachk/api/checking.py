"""Everything that reading a model finds, as `tachk check` reports it."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress

from tachk.api.model import Model
from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, TachkError, UnsupportedError, UsageError
from tachk.base.span import Source
from tachk.engine.compiler.features import uncomputed_chances, undrawn_ends
from tachk.formats.loading.load import load_model
from tachk.formats.uppaal.versions import UppaalVersion
from tachk.report.check_report import Checked, Size


def check_model(
    written: str | Source, constants: Mapping[str, str], version: UppaalVersion | None = None, strict_xta: bool = False
) -> tuple[Checked, Model | None]:
    """The findings from reading a model, and the model if it can be used.

    Args:
        written: the path of a file, or a text.
        version: of UPPAAL; report also what it would refuse or treat otherwise.
        strict_xta: refuse what tachk adds to the language of UPPAAL.
    """
    path = written if isinstance(written, str) else written.name
    try:
        model = Model(load_model(written, constants, strict_xta), path, tuple(constants))
    except InputError as error:
        return Checked(path, findings=error.diagnostics), None
    except UnsupportedError as error:
        return Checked(path, findings=(error.diagnostic,)), None
    except UsageError as error:
        return Checked(path, complaint=error.message, help=error.help), None
    if model.refusals:
        return Checked(path, findings=(*model.refusals, *model.warnings)), None
    processes = model.network.processes
    size = Size(
        len(processes),
        sum(len(process.locations) for process in processes),
        sum(len(process.edges) for process in processes),
        len(model.loaded.formulas),
    )
    other = None
    if version is not None:
        from tachk.formats.uppaal.portability import portability

        other = portability(model.loaded, version)
    of_simulations = (*_uncomputed(model, written, strict_xta), *undrawn_ends(model.network))
    return Checked(path, size, (*model.warnings, *of_simulations), other), model


def _uncomputed(model: Model, written: str | Source, strict_xta: bool) -> tuple[Diagnostic, ...]:
    """The rates and weights that no simulation computes. It has floating point variables and hybrid clocks besides."""
    wrong = uncomputed_chances(model.network)
    if wrong:
        with suppress(TachkError):
            constants = {name: value.span.text for name, value in model.loaded.overrides.items()}
            simulated = load_model(written, constants, strict_xta, keeps_doubles=True)
            return uncomputed_chances(simulated.network)
    return wrong
