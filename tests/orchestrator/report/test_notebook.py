"""Cards for notebooks: whole HTML, every text escaped, nothing that is fetched or run."""

from __future__ import annotations

import lxml.etree
import lxml.html
from rich.table import Table as RichTable

from orchestrator.report.notebook import Card, of_terminal, rendered
from orchestrator.report.table import Cell, Column, Table

NASTY = "<script>alert(1)</script>&\"'</table>"


def test_all_texts_are_escaped() -> None:
    table = Table(NASTY, [Column(NASTY, number=True)], [[Cell(NASTY, note=NASTY)]])
    page = lxml.html.fromstring(rendered(Card(NASTY, [NASTY], [table], [table])))
    assert not page.xpath("//script | //link | //img | //iframe | //@src | //@onclick")
    shown = page.text_content()
    assert shown.count(NASTY) == 2 + 2 * 4 + 1
    assert len(page.xpath("//table")) == 2


def test_it_is_well_formed_and_what_is_more_is_folded_away() -> None:
    first, second = (Table(name, [Column("a")], [[Cell("1")]]) for name in ("first", "second"))
    page = lxml.etree.fromstring(rendered(Card("title", ["line"], [first], [second])).strip())
    assert [c.text for c in page.xpath("//caption")] == ["first", "second"]
    assert [c.text for c in page.xpath("//details//caption")] == ["second"]
    assert page.xpath("//summary")[0].text == "second"
    assert not page.xpath("//details[@open]")


def test_without_more_nothing_is_folded() -> None:
    assert "<details" not in rendered(Card("title"))


def test_a_table_of_the_terminal_keeps_its_texts() -> None:
    made = RichTable("from", "to", title="wires")
    made.add_row("a[b]", "c\u202ed")
    made.add_row("e", "f" * 5000)
    table = of_terminal(made)
    assert (table.title, [c.title for c in table.columns]) == ("wires", ["from", "to"])
    texts = [[cell.text for cell in row] for row in table.rows]
    assert texts[0] == ["a[b]", "c\\u202ed"]
    assert texts[1][0] == "e" and len(texts[1][1]) < 1100
