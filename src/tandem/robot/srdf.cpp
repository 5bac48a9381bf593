#include "tandem/robot/srdf.h"

#include <algorithm>
#include <set>

#include "tandem/core/file.h"
#include "tandem/core/names.h"
#include "tandem/robot/xml_reader.h"

namespace tandem::robot {

namespace {

template <class T>
std::vector<std::string> names_of(const std::vector<T>& items) {
  std::vector<std::string> names;
  for (const T& item : items) names.push_back(item.name);
  return names;
}

class SrdfReader {
 public:
  SrdfReader(XmlElement robot, const Model& model) : robot_(robot), model_(model) {}

  Semantics read() {
    for (const XmlElement& element : robot_.children("virtual_joint")) {
      virtual_joints_.insert(element.required("name"));
    }
    for (const XmlElement& element : robot_.children("group")) {
      const std::string name = element.required("name");
      for (const GroupElement& other : groups_) {
        if (other.name == name) {
          element.fail("the name exists already, in line " + std::to_string(other.element.line()));
        }
      }
      groups_.push_back({name, element, {}, GroupElement::State::kNew});
    }
    Semantics semantics;
    for (GroupElement& group : groups_) {
      resolve(group, group.element);
      semantics.groups.push_back(make_group(group));
    }
    for (const XmlElement& element : robot_.children("group_state")) {
      semantics.states.push_back(read_state(element, semantics));
    }
    for (const XmlElement& element : robot_.children("disable_collisions")) {
      DisabledPair pair{element.required("link1"), element.required("link2"),
                        element.attribute("reason").value_or("")};
      const bool known = model_.find_link(pair.link_a) >= 0 && model_.find_link(pair.link_b) >= 0;
      (known ? semantics.disabled_pairs : semantics.ignored_pairs).push_back(std::move(pair));
    }
    for (const XmlElement& element : robot_.children("enable_collisions")) {
      const std::string a = element.required("link1"), b = element.required("link2");
      std::erase_if(semantics.disabled_pairs, [&](const DisabledPair& pair) {
        return (pair.link_a == a && pair.link_b == b) || (pair.link_a == b && pair.link_b == a);
      });
    }
    return semantics;
  }

 private:
  struct GroupElement {
    std::string name;
    XmlElement element;
    std::set<int> links;  ///< Child links of the group's joints.
    enum class State { kNew, kOpen, kResolved } state;
  };

  int find_link(const XmlElement& element, const char* attribute) const {
    const std::string name = element.required(attribute);
    const int link = model_.find_link(name);
    if (link < 0) {
      element.fail("no link '" + name + "' in robot '" + model_.name() + "'" +
                   name_hint(name, names_of(model_.links())));
    }
    return link;
  }

  /// -1 for a virtual joint, which places the robot and is not part of the model.
  int find_joint(const XmlElement& element) const {
    const std::string name = element.required("name");
    const int joint = model_.find_joint(name);
    if (joint < 0 && !virtual_joints_.contains(name)) {
      element.fail("no joint '" + name + "' in robot '" + model_.name() + "'" +
                   name_hint(name, names_of(model_.joints())));
    }
    return joint;
  }

  /// Collects the group's links; `from` is the element that asked for it.
  void resolve(GroupElement& group, const XmlElement& from) {
    if (group.state == GroupElement::State::kResolved) return;
    if (group.state == GroupElement::State::kOpen) {
      from.fail("group '" + group.name + "' contains itself");
    }
    group.state = GroupElement::State::kOpen;
    for (const XmlElement& part : group.element.children()) {
      const std::string tag = part.tag();
      if (tag == "chain") {
        add_chain(part, group);
      } else if (tag == "joint") {
        const int joint = find_joint(part);
        if (joint >= 0) group.links.insert(model_.joints()[std::size_t(joint)].child_link);
      } else if (tag == "link") {
        group.links.insert(find_link(part, "name"));
      } else if (tag == "group") {
        const std::string name = part.required("name");
        const auto found = std::ranges::find(groups_, name, &GroupElement::name);
        if (found == groups_.end()) {
          part.fail("no group '" + name + "'" + name_hint(name, names_of(groups_)));
        }
        resolve(*found, part);
        group.links.insert(found->links.begin(), found->links.end());
      } else if (tag != "passive_joint") {
        part.fail("expected chain, joint, link or group");
      }
    }
    group.state = GroupElement::State::kResolved;
  }

  void add_chain(const XmlElement& element, GroupElement& group) const {
    const int base = find_link(element, "base_link"), tip = find_link(element, "tip_link");
    const auto chain = model_.chain(base, tip);
    if (!chain) element.fail(chain.error().message);
    for (const int joint : *chain) {
      group.links.insert(model_.joints()[std::size_t(joint)].child_link);
    }
  }

  /// Links come parents first, so a group is one chain if its last link is below all others.
  Group make_group(const GroupElement& source) const {
    Group group;
    group.name = source.name;
    for (const int link : source.links) {
      const int joint = model_.links()[std::size_t(link)].parent_joint;
      if (joint >= 0 && model_.joints()[std::size_t(joint)].position_index >= 0) {
        group.joints.push_back(joint);
      }
    }
    if (source.links.empty()) return group;
    const int last = *source.links.rbegin();
    const bool is_chain = std::ranges::all_of(
        source.links, [&](int link) { return model_.chain(link, last).has_value(); });
    if (is_chain) group.tip_link = last;
    return group;
  }

  NamedState read_state(const XmlElement& element, const Semantics& semantics) const {
    NamedState state{element.required("name"), element.required("group"), {}};
    const Group* group = semantics.find_group(state.group);
    if (!group) {
      element.fail("no group '" + state.group + "'" +
                   name_hint(state.group, names_of(semantics.groups)));
    }
    if (semantics.find_state(state.group, state.name)) {
      element.fail("group '" + state.group + "' has a state of this name already");
    }
    for (const XmlElement& entry : element.children("joint")) {
      const int joint = find_joint(entry);
      if (joint < 0) continue;
      const double value = entry.number("value");
      const Joint& named = model_.joints()[std::size_t(joint)];
      // What is fixed or follows another joint has no value of its own.
      if (named.position_index < 0) continue;
      if (std::ranges::find(group->joints, joint) == group->joints.end()) {
        entry.fail("joint '" + named.name + "' is not in group '" + group->name + "'");
      }
      if (!state.values.emplace(named.name, value).second) {
        entry.fail("joint '" + named.name + "' has a value already");
      }
    }
    return state;
  }

  XmlElement robot_;
  const Model& model_;
  std::set<std::string> virtual_joints_;
  std::vector<GroupElement> groups_;
};

}  // namespace

const Group* Semantics::find_group(std::string_view name) const {
  const auto found = std::ranges::find(groups, name, &Group::name);
  return found == groups.end() ? nullptr : &*found;
}

const NamedState* Semantics::find_state(std::string_view group, std::string_view name) const {
  const auto found = std::ranges::find_if(
      states, [&](const NamedState& s) { return s.group == group && s.name == name; });
  return found == states.end() ? nullptr : &*found;
}

Result<Semantics> load_srdf(const std::filesystem::path& file, const Model& model) {
  const auto text = read_file(file);
  if (!text) return std::unexpected(text.error());
  return parse_srdf(*text, file.string(), model);
}

Result<Semantics> parse_srdf(const std::string& text, const std::string& origin,
                             const Model& model) {
  try {
    const XmlDocument document(text, origin, "robot");
    return SrdfReader(document.root(), model).read();
  } catch (const ReadFailure& failure) {
    return std::unexpected(failure.error);
  }
}

}  // namespace tandem::robot
