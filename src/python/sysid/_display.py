"""Models and results as notebooks show them: small tables in HTML, formulas as MathML, figures as SVG."""

from __future__ import annotations

import base64
import html
import math
import pathlib
import re
from typing import Any, Iterator, Mapping, Sequence

from ._words import in_python

_LEFT = "style='text-align:left'"


def _escaped(value: Any) -> str:
    return html.escape(str(value))


def _marked(text: str) -> str:
    """A message, whose `names` stand between back ticks."""
    return re.sub("`([^`]+)`", r"<code>\1</code>", _escaped(text))


def significant(value: "float | None", digits: int = 3) -> str:
    if value is None:
        return ""
    shown = f"{value:.{digits}g}"
    return re.sub(r"e([+-])0*(\d)", lambda power: "e" + power[1].replace("+", "") + power[2], shown)


def beside(value: float, sd: "float | None") -> str:
    """A number with the digits that the first two of its standard deviation have: 19.998 for 0.016."""
    if value is None:
        return ""
    if not sd or not math.isfinite(sd) or not math.isfinite(value):
        return f"{value:.6g}"
    place = math.floor(math.log10(sd)) - 1
    if 1e-4 <= max(abs(value), sd) < 1e6:
        return f"{value:.{max(0, -place)}f}"
    power = math.floor(math.log10(max(abs(value), sd)))
    return f"{value / 10.0**power:.{min(15, max(0, power - place))}f}e{power}"


def table(head: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """Cells are HTML; the first columns, as many as `left`, hold words."""

    def cells(tag: str, row: Sequence[str]) -> str:
        return "".join(f"<{tag}{' ' + _LEFT if i < left else ''}>{cell}</{tag}>" for i, cell in enumerate(row))

    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows)
    return f"<table><thead><tr>{cells('th', head)}</tr></thead><tbody>{body}</tbody></table>"


def verdict(passes: bool, text: str, found: Sequence[Mapping[str, Any]]) -> str:
    if not text:
        return ""
    mark, colour = ("✓", "#2e7d32") if passes else ("✗", "#c62828")
    if passes and any(each["severity"] == "warning" for each in found):
        mark, colour = "!", "#b26a00"
    return f"<p><b style='color:{colour}'>{mark}</b> {_marked(text)}</p>"


def findings(found: Sequence[Mapping[str, Any]]) -> str:
    rows = []
    for each in found:
        help = f"<br><i>{_marked(in_python(each['help']))}</i>" if each.get("help") else ""
        rows.append(f"<li>{_escaped(each['severity'])} <code>{_escaped(each['code'])}</code>: {_marked(each['message'])}{help}</li>")
    return f"<ul>{''.join(rows)}</ul>" if rows else ""


def folded(title: str, text: str) -> str:
    return f"<details><summary>{_escaped(title)}</summary><pre>{_escaped(text)}</pre></details>" if text else ""


# ---- results


def _parameters(parameters: Mapping[str, Mapping[str, Any]]) -> str:
    if not parameters:
        return ""
    columns = [("r-hat", "rhat", 3), ("ESS", "ess_bulk", 0)]
    columns = [each for each in columns if any(row.get(each[1]) is not None for row in parameters.values())]
    interval = any(row.get("q5") is not None for row in parameters.values())
    head = ["", "unit", "mean" if interval else "optimum", "sd", *(["90 % interval"] if interval else []), *(each[0] for each in columns)]
    rows = []
    for name, of in parameters.items():
        sd = of.get("sd")
        row = [_escaped(name), _escaped(of.get("unit") or ""), beside(of.get("mean"), sd), significant(sd, 2)]
        if interval:
            row.append(f"{beside(of.get('q5'), sd)} to {beside(of.get('q95'), sd)}" if of.get("q5") is not None else "")
        rows.append(row + ["" if of.get(key) is None else f"{of[key]:.{decimals}f}" for _, key, decimals in columns])
    return table(head, rows, left=2)


def _errors(fit: Mapping[str, Any]) -> str:
    """How far channels are off, and how many samples the bands hold."""
    columns = [("error [%]", "nmse", "normalised mean squared error"), ("rmse", "rmse", ""), ("in the 95 % band", "coverage_95", "")]
    rows = [
        [_escaped(f"{channel} on {data}"), *(significant(of.get(key)) for _, key, _ in columns)]
        for data, channels in fit.get("channels", {}).items()
        for channel, of in channels.items()
    ]
    return table(["", *(title for title, _, _ in columns)], rows) if rows else ""


def _models(models: Mapping[str, Mapping[str, Any]]) -> str:
    if not models:
        return ""
    best = sorted(models.items(), key=lambda each: -(each[1].get("probability") or 0))
    rows = [
        [_escaped(name), f"{of['probability']:.3f}" if of.get("probability", 0) >= 5e-4 else "&lt; 0.001", "" if of.get("log_evidence") is None else f"{of['log_evidence']:.2f}"]
        for name, of in best
    ]
    evidence = any(row[2] for row in rows)
    return table(["model", "probability", *(["log evidence"] if evidence else [])], [row if evidence else row[:2] for row in rows])


def _equations(discovery: Mapping[str, Any]) -> str:
    parts = []
    for equation in discovery.get("equations", []):
        measure = discovery.get("measure", "")
        rows = []
        for term in equation["terms"]:
            kept = term["kept"]
            rows.append(
                [
                    f"<code>{_escaped(term['term'])}</code>",
                    beside(term.get("coefficient"), term.get("sd")) if kept else "",
                    significant(term.get("sd"), 2) if kept else "",
                    _escaped(term.get("unit") or ""),
                    "" if term.get("measure") is None else f"{term['measure']:.3f}",
                ]
            )
        parts.append(f"<p><code>{_escaped(equation['equation'])}</code></p>")
        parts.append(table([f"terms of {_escaped(equation['target'])}", "coefficient", "sd", "unit", _escaped(measure)], rows))
    return "".join(parts)


def result(summary: Mapping[str, Any], text: str, interrupted: bool) -> str:
    of = summary.get("verdict", {})
    parts = [f"<p><b>{_escaped(summary.get('task', ''))}</b>: {_escaped(summary.get('what', ''))}</p>"]
    if interrupted:
        parts.append("<p>interrupted: these are the draws so far</p>")
    found = summary.get("findings", [])
    parts.append(verdict(of.get("pass", True), of.get("text", ""), found))
    parts.append(findings(found))
    parts.append(_models(summary.get("models", {})))
    parts.append(_equations(summary.get("discovery", {})))
    parts.append(_parameters(summary.get("parameters", {})))
    if summary.get("verb") == "predict":
        parts.append(_errors(summary.get("fit", {})))
    parts.append(folded("as the command line prints it", text))
    return "".join(parts)


def check(content: Mapping[str, Any], text: str) -> str:
    messages = [each for each in content.get("messages", []) if each.get("message")]
    rows = []
    for task in content.get("tasks", []):
        information = task.get("information") or {}
        for of in information.get("parameters", []):
            percent = 100 if of.get("relative") else 1
            unit = " %" if of.get("relative") else f" {of.get('unit') or ''}"
            sd = of.get("expected_sd")
            expected = f"{percent * sd[0]:.2g} to {percent * sd[1]:.2g}{unit}" if sd else of.get("instead", "")
            rows.append([_escaped(task["name"]), _escaped(of["name"]), _escaped(expected)])
    found = [each for task in content.get("tasks", []) for each in task.get("findings", [])]
    parts = [f"<p><b>check</b> of {_escaped(content.get('file', ''))}</p>"]
    parts.append(findings([{"code": "", **each} for each in messages]))
    parts.append(findings(found))
    if rows:
        parts.append(table(["task", "parameter", "expected sd after the fit"], rows, left=2))
    parts.append(folded("as the command line prints it", text))
    return "".join(parts)


def _checks(fit: Mapping[str, Any]) -> str:
    if not fit.get("pass"):
        return "fail"
    warnings = fit.get("warnings") or 0
    return f"{warnings} warning{'s' if warnings > 1 else ''}" if warnings else "pass"


def comparison(content: Mapping[str, Any], text: str) -> str:
    parts = [f"<p><b>comparison</b> on {_escaped(content.get('data', ''))}</p>"]
    fits = content.get("fits", [])
    if fits:
        rows = [
            [
                _escaped(each["name"]),
                _escaped(each.get("model") or ""),
                "" if each.get("log_evidence") is None else f"{each['log_evidence']:.2f}",
                "" if each.get("probability") is None else f"{each['probability']:.3f}",
                _checks(each),
            ]
            for each in fits
        ]
        parts.append(table(["fit", "model", "log evidence", "probability", "checks"], rows, left=2))
    parts.append(folded("as the command line prints it", text))
    return "".join(parts)


# ---- models


def model(path: str, models: Sequence[tuple], data: Sequence[tuple], tasks: Sequence[tuple[str, str]]) -> str:
    """models: name, title, statements with their headings as MathML, LaTeX. data: name, file, columns."""
    parts = [f"<p><b>{_escaped(path)}</b></p>"]
    for name, title, statements, _ in models:
        parts.append(f"<p><b>model {_escaped(name)}</b>{': ' + _escaped(title) if title else ''}</p>")
        for heading in ("equations", "observed", "parameters", "definitions"):
            formulas = [formula for of, formula in statements if of == heading]
            if formulas:
                # Without display="block" they stand at the left, one below the other.
                shown = "<br>".join(each.replace('display="block"', 'displaystyle="true"', 1) for each in formulas)
                parts.append(f"<p style='margin-left:1em'><small>{heading}</small><br>{shown}</p>")
    if data:
        rows = [[_escaped(name), _escaped(file), _escaped(", ".join(dict.fromkeys(columns)))] for name, file, columns in data]
        parts.append(table(["data", "file", "columns"], rows, left=3))
    if tasks:
        parts.append(table(["task", "verb"], [[_escaped(name), _escaped(verb)] for name, verb in tasks], left=2))
    return "".join(parts)


# ---- figures


class Figure:
    """A figure of a result; a notebook shows it."""

    def __init__(self, path: pathlib.Path) -> None:
        self.name = path.stem
        self.svg = path.read_text(encoding="utf-8")  #: the picture, as text

    def _repr_html_(self) -> str:
        # As an image: names in it stay its own, and nbconvert 6.5 shows nothing of an SVG in the page itself.
        picture = base64.b64encode(self.svg.encode()).decode()
        size = re.search(r'viewBox="0 0 (\d+) (\d+)"', self.svg)
        width = f" width='{size[1]}'" if size else ""
        return f"<img alt='{_escaped(self.name)}'{width} style='max-width:100%' src='data:image/svg+xml;base64,{picture}'>"

    def save(self, path: Any) -> None:
        """Writes the picture, an SVG: ValueError for a name that says otherwise."""
        suffix = pathlib.Path(path).suffix
        if suffix.lower() not in ("", ".svg"):
            raise ValueError(f"figures are saved as SVG, not as {suffix}: name the file {pathlib.Path(path).stem}.svg")
        pathlib.Path(path).write_text(self.svg, encoding="utf-8")

    def __repr__(self) -> str:
        return f"sysid figure {self.name}"


class Figures(Mapping[str, Figure]):
    """The figures of a result by their names; drawn when the first is asked for, which needs gnuplot."""

    def __init__(self, folder: pathlib.Path, draw: Any) -> None:
        self._folder, self._draw = folder / "figures", draw

    def _names(self) -> list[str]:
        # What is drawn without a script stands there already.
        return sorted({path.stem for path in self._folder.glob("*") if path.suffix in (".gnuplot", ".svg")})

    def __getitem__(self, name: str) -> Figure:
        if name not in self._names():
            raise KeyError(f"no figure {name!r}; there are {', '.join(self)}")
        path = self._folder / f"{name}.svg"
        if not path.exists():
            self._draw()
        return Figure(path)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names())

    def __len__(self) -> int:
        return len(self._names())

    def __repr__(self) -> str:
        return f"figures: {', '.join(self)}"
