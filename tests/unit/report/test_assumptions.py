from example_artifacts import gather

from softfinger.report.sections.outlook import build_outlook


def test_the_report_says_and_shows_where_the_assumptions_hold(material):
    section = build_outlook(material)
    assert any("The torque grows by 17 %." in item for item in section.blocks[1].items)
    assert section.blocks[2].name == "assumptions"
    assert "4 simulated fingers of the paper's table under 8 N" in section.blocks[2].caption


def test_without_the_check_the_report_says_nothing_of_it(artifacts):
    few = {name: part for name, part in artifacts.items() if name != "assumptions"}
    section = build_outlook(gather(few))
    assert len(section.blocks) == 2
    assert not any("imulated fingers" in item for item in section.blocks[1].items)
