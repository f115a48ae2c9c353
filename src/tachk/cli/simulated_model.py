"""Models as simulations and their judges read them: with floating point variables."""

from __future__ import annotations

from tachk.api.model import Model
from tachk.base.records import dataclass
from tachk.cli.arguments import parse_definitions
from tachk.cli.guard import print_diagnostics
from tachk.formats.loading.load import load_model
from tachk.simulation.stepping.files import check_determined, constants_of
from tachk.simulation.stepping.submitted import SubmittedRun


def simulated_model(path: str, **constants: int | bool | str) -> Model:
    """As `tachk.api.model.load`."""
    return Model(load_model(path, constants, keeps_doubles=True), path, tuple(constants))


@dataclass(frozen=True, slots=True)
class ModelOfRun:
    """A model with the values of constants that a run was made with.

    Attributes:
        of_run: the constants that have another value because of the run.
        constants: those, and the ones that the user has chosen, with their values.
    """

    model: Model
    of_run: dict[str, int]
    constants: dict[str, int]


def model_of_run(path: str, definitions: tuple[str, ...], submitted: SubmittedRun | None) -> ModelOfRun:
    """Loads the model that a run is about, or the model as it is where there is none, and prints what there is to say.

    Raises UsageError for a run of another model, and for a model whose runs cannot be replayed.
    """
    given = parse_definitions(definitions)
    model = simulated_model(path, **given)
    of_run = {} if submitted is None else constants_of(submitted, model.constants, given)
    if of_run:
        model = simulated_model(path, **of_run, **given)
    print_diagnostics((*model.refusals, *model.warnings))
    check_determined(model.network)
    constants = {name: value for name, value in model.constants.items() if name in {**of_run, **given}}
    return ModelOfRun(model, of_run, constants)
