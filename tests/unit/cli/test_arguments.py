from __future__ import annotations

from contextlib import chdir
from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.arguments import parse_definitions, parse_size, split_models_and_queries


def test_existing_files_are_models_and_formulas_are_queries(tmp_path: Path) -> None:
    (tmp_path / "a.ta").touch()
    (tmp_path / "odd name").touch()
    with chdir(tmp_path):
        assert split_models_and_queries(["a.ta", "E<> P.x", "odd name", "p --> q", "sup: x", "inf{a} : y"]) == (
            ("a.ta", "odd name"),
            ("E<> P.x", "p --> q", "sup: x", "inf{a} : y"),
        )


@pytest.mark.parametrize("argument", ["gone.ta", "gone.xml", "word", "a/b.xta", ".", "-", ""])
def test_what_is_neither_is_rejected(argument: str, tmp_path: Path) -> None:
    (tmp_path / "a.ta").touch()
    with chdir(tmp_path), pytest.raises(UsageError):
        split_models_and_queries(["a.ta", argument])


def test_an_overlong_argument_is_a_query(tmp_path: Path) -> None:
    (tmp_path / "a.ta").touch()
    query = "A[] " + " && ".join(["x > 0"] * 2000)
    with chdir(tmp_path):
        assert split_models_and_queries(["a.ta", query]) == (("a.ta",), (query,))


def test_a_long_formula_is_no_name_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "a.ta").touch()
    query = "A[]" + "(P.a)" * 60
    with chdir(tmp_path):
        assert split_models_and_queries(["a.ta", query]) == (("a.ta",), (query,))


def test_definitions_keep_their_expressions() -> None:
    assert parse_definitions(["N=4", " LOSS = 2 * 3", "B=x==1"]) == {"N": "4", "LOSS": "2 * 3", "B": "x==1"}


@pytest.mark.parametrize("definition", ["N", "N=", "=4", "3=4", "a b=1"])
def test_malformed_definitions_are_rejected(definition: str) -> None:
    with pytest.raises(UsageError):
        parse_definitions([definition])


@pytest.mark.parametrize("values", ["1..3", "1:3", "0:1:5", "-1 .. N", "1,2,3", "1...3"])
def test_a_range_of_values_is_rejected_with_the_reason(values: str) -> None:
    with pytest.raises(UsageError, match=f"-D N={values}: one value at a time") as caught:
        parse_definitions([f"N={values}"])
    assert caught.value.help is not None
    assert "tachk sweep MODEL -D N=" in caught.value.help


@pytest.mark.parametrize(
    ("values", "said"), [("1..3", "1..3"), ("-1...4", "-1..4"), ("2:5", "2..5"), ("1,2", "1,2"), ("0:1:5", "LOW..HIGH")]
)
def test_a_range_of_values_is_said_as_the_command_for_it_takes_it(values: str, said: str) -> None:
    with pytest.raises(UsageError) as caught:
        parse_definitions([f"N={values}"])
    assert caught.value.help is not None
    assert caught.value.help.endswith(f"-D N={said}")


@pytest.mark.parametrize("value", ["B ? 1 : 3", "f(1, 2)", "M", "-3", "1 + 2"])
def test_an_expression_is_no_range(value: str) -> None:
    assert parse_definitions([f"N={value}"]) == {"N": value}


@pytest.mark.parametrize(
    ("text", "size"), [("12", 12), ("500M", 500_000_000), ("1.5 GiB", 3 << 29), ("2gb", 2 * 10**9), ("3k", 3000)]
)
def test_sizes(text: str, size: int) -> None:
    assert parse_size(text) == size


@pytest.mark.parametrize("text", ["", "M", "-1", "2T", "1 2"])
def test_malformed_sizes_are_rejected(text: str) -> None:
    with pytest.raises(UsageError):
        parse_size(text)
