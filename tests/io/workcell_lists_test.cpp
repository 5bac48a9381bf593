// Lists of queries, and what queries attach and detach, in workcell files.

#include "documented_cell.h"

namespace tandem::io {
namespace {

using test::DocumentedCell;
using test::Fault;
using test::kAbsent;
using test::with;

TEST_F(DocumentedCell, CarriesThings) {
  const auto loaded = load(text_);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const world::Workcell& cell = **loaded;
  ASSERT_EQ(cell.lists().size(), 1u);
  ASSERT_EQ(cell.lists()[0].queries.size(), 3u);
  EXPECT_TRUE(cell.query("tidy/reach").changes.empty());
  const world::SceneChanges& carry = cell.query("tidy/carry").changes;
  ASSERT_EQ(carry.attach.size(), 1u);
  EXPECT_EQ(carry.attach[0].object, "book");
  EXPECT_EQ(carry.attach[0].arm, "left");
  EXPECT_FALSE(carry.attach[0].pose);
  EXPECT_EQ(carry.attach[0].touching, std::vector<std::string>{"right/panda_hand"});
  ASSERT_EQ(carry.allowed.size(), 1u);
  EXPECT_EQ(carry.allowed[0].b, "shelf");
  const world::SceneChanges& leave = cell.query("tidy/leave").changes;
  ASSERT_EQ(leave.detach.size(), 1u);
  EXPECT_EQ(leave.detach[0].X_WO->translation().x(), 0.5);
  // Frames: the obstacle's pose, and that of what is attached in its link.
  EXPECT_EQ(cell.find_object("book")->X_LO.translation().z(), 0.42);
  EXPECT_EQ(cell.find_object("gear")->X_LO.translation().z(), 0.1034);
  EXPECT_EQ(cell.find_object("gear")->link, "left/panda_hand");

  const auto names = load(
      with(text_, "detach: [{object: book, place: {xyz: [0.5, 0, 0]}}]", "detach: [book, gear]"));
  ASSERT_TRUE(names) << names.error().message;
  EXPECT_EQ((*names)->query("tidy/leave").changes.detach[1].object, "gear");
  EXPECT_FALSE((*names)->query("tidy/leave").changes.detach[0].X_WO);
}

const std::vector<Fault> kListFaults = {
    {"attach: [{object: book", "atach: [{object: book", "atach", {"mean 'attach'"}},
    {"attach: [{object: book", "attach: [{objct: book", "objct", {"mean 'object'"}},
    {"attach: [{object: book",
     "attach: [{object: bok",
     "object: bok",
     {"no object 'bok'", "mean 'book'", "before query 'tidy/carry'"},
     kAbsent},
    {"object: book, arm: left, t",
     "object: book, arm: letf, t",
     "arm: letf",
     {"arm 'letf'", "mean 'left'"},
     kAbsent},
    {"object: book, arm: left, t", "object: book, t", "object: book, t", {"needed: arm, link"}},
    {"object: book, arm: left, t",
     "object: book, link: left/panda_link0, t",
     "left/panda_link0, t",
     {"'left/panda_link0', which no arm moves"}},
    {"object: book, arm: left, t",
     "object: book, arm: left, at: {xzy: [0, 0, 0]}, t",
     "xzy",
     {"mean 'xyz'"}},
    {"touching: [right/panda_hand]}]",
     "touching: [right/panda_hnd]}]",
     "panda_hnd",
     {"mean 'right/panda_hand'"},
     kAbsent},
    {"b: shelf, reason", "b: shelv, reason", "shelv", {"mean 'shelf'"}, kAbsent},
    {"detach: [{object: book",
     "detach: [{object: table",
     "object: table",
     {"'table' cannot be detached: nothing carries it"}},
    {"place: {xyz: [0.5, 0, 0]}", "place: [0.5, 0, 0]", "place: [", {"must be a map"}},
    {"lists:\n  tidy:\n", "lists:\n  - tidy:\n", "- tidy", {"lists must be a map"}},
    {"  tidy:\n", "  ti/dy:\n", "- name: reach", {"must not contain '/'"}},
    {"    - name: leave\n", "    - name: carry\n", "- name: carry\n      detach", {"rename"}},
};

TEST_F(DocumentedCell, WithSpoiltListsIsRefusedWithPlaceAndRemedy) {
  for (const Fault& fault : kListFaults) expect_refused(fault);
}

}  // namespace
}  // namespace tandem::io
