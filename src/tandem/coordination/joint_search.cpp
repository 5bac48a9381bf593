#include "tandem/coordination/joint_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <deque>
#include <unordered_map>

#include "tandem/coordination/deadlock.h"
#include "tandem/coordination/raster.h"
#include "tandem/coordination/taut_way.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {

using Eigen::Index, Eigen::VectorXd;

namespace {

using Place = std::vector<int>;  ///< By arm: steps of the grid, or units.

struct Pair {
  int i, j;
  CoordinationDiagram diagram;
};

class JointSearch {
 public:
  JointSearch(const CoordinationProblem& problem, const JointOptions& options,
              const StopCondition& stop)
      : problem_(problem), options_(options), stop_(stop) {
    const int arms = static_cast<int>(problem.arms.size());
    for (int i = 0; i < arms; ++i) tracks_.emplace_back(problem, i);
    for (int i = 0; i < arms; ++i) {
      for (int j = i + 1; j < arms; ++j) {
        const auto at = [&](int k) -> const Track& { return tracks_[static_cast<std::size_t>(k)]; };
        pairs_.push_back({i, j, {problem, at(i), at(j), options.diagram}});
      }
    }
  }

  Result<Schedule> run();

 private:
  enum class Outcome { kFound, kExhausted, kGaveUp, kStopped };
  struct Grid {
    Raster raster;
    std::vector<int> left[2];  // Steps to the goal, by passage.
  };
  struct Node {
    std::int64_t parent;
    int g;
    bool is_done = false;
  };
  struct Entry {
    int f, g;
    std::int64_t key;
    bool operator<(const Entry& other) const {
      return f != other.f ? f > other.f : g != other.g ? g < other.g : key > other.key;
    }
  };

  Outcome search(Passage passage);
  bool is_step_free(const Place& from, const Place& to, Passage passage) const;
  int steps_left(const Place& place, Passage passage) const;
  Place place_of(std::int64_t key) const;
  std::int64_t key_of(const Place& place) const;
  double time_of(std::size_t arm, int units) const;
  Schedule schedule() const;
  std::string blocking() const;
  bool is_visible(const Place& a, const Place& b) const;

  const CoordinationProblem& problem_;
  const JointOptions& options_;
  const StopCondition& stop_;
  std::deque<Track> tracks_;
  std::deque<Pair> pairs_;
  std::vector<Grid> grids_;  // By pair.
  int size_ = 1;
  Place goal_;              // [steps]
  std::vector<Place> way_;  // [steps]
  std::vector<int> units_;  // By arm, of its whole motion.
};

std::int64_t JointSearch::key_of(const Place& place) const {
  std::int64_t key = 0;
  for (std::size_t i = 0; i < place.size(); ++i) key = key * (goal_[i] + 1) + place[i];
  return key;
}

Place JointSearch::place_of(std::int64_t key) const {
  Place place(goal_.size());
  for (std::size_t i = goal_.size(); i-- > 0;) {
    place[i] = static_cast<int>(key % (goal_[i] + 1));
    key /= goal_[i] + 1;
  }
  return place;
}

bool JointSearch::is_step_free(const Place& from, const Place& to, Passage passage) const {
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const auto i = static_cast<std::size_t>(pairs_[k].i), j = static_cast<std::size_t>(pairs_[k].j);
    if (!grids_[k].raster.is_step(from[i], from[j], to[i] - from[i], to[j] - from[j], passage)) {
      return false;
    }
  }
  return true;
}

/// -1 if a pair of arms cannot reach its goal from here.
int JointSearch::steps_left(const Place& place, Passage passage) const {
  int most = 0;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const auto i = static_cast<std::size_t>(pairs_[k].i), j = static_cast<std::size_t>(pairs_[k].j);
    const auto& left = grids_[k].left[passage == Passage::kProven ? 0 : 1];
    const int steps = left[static_cast<std::size_t>(grids_[k].raster.node(place[i], place[j]))];
    if (steps < 0) return -1;
    most = std::max(most, steps);
  }
  return most;
}

JointSearch::Outcome JointSearch::search(Passage passage) {
  const Place start(goal_.size(), 0);
  const int least = steps_left(start, passage);
  if (least < 0) return Outcome::kExhausted;
  std::unordered_map<std::int64_t, Node> nodes{{key_of(start), {-1, 0}}};
  std::vector<Entry> queue{{least, 0, key_of(start)}};
  const std::int64_t goal_key = key_of(goal_);
  std::int64_t moves = 1;
  for (std::size_t i = 0; i < goal_.size(); ++i) moves *= 3;
  long expanded = 0;
  while (!queue.empty()) {
    std::pop_heap(queue.begin(), queue.end());
    const Entry entry = queue.back();
    queue.pop_back();
    Node& node = nodes.at(entry.key);
    if (node.is_done) continue;
    node.is_done = true;
    if (entry.key == goal_key) {
      way_.clear();
      for (std::int64_t key = goal_key; key >= 0; key = nodes.at(key).parent) {
        way_.push_back(place_of(key));
      }
      std::ranges::reverse(way_);
      return Outcome::kFound;
    }
    if (++expanded > options_.most_nodes) return Outcome::kGaveUp;
    if (expanded % 64 == 0 && stop_()) return Outcome::kStopped;
    const Place from = place_of(entry.key);
    for (std::int64_t move = 0; move < moves; ++move) {
      Place to = from;
      bool inside = true;
      std::int64_t rest = move;
      for (std::size_t i = 0; i < to.size(); ++i, rest /= 3) {
        const int d = static_cast<int>(rest % 3) - 1;
        inside &= !(options_.search.monotone && d < 0);
        to[i] += d;
        inside &= to[i] >= 0 && to[i] <= goal_[i];
      }
      if (!inside || to == from || !is_step_free(from, to, passage)) continue;
      const int left = steps_left(to, passage);
      if (left < 0) continue;
      const std::int64_t key = key_of(to);
      const auto [known, is_new] = nodes.try_emplace(key, Node{entry.key, entry.g + 1});
      if (!is_new && known->second.g <= entry.g + 1) continue;
      known->second = {entry.key, entry.g + 1};
      queue.push_back({entry.g + 1 + left, entry.g + 1, key});
      std::push_heap(queue.begin(), queue.end());
    }
  }
  return Outcome::kExhausted;
}

bool JointSearch::is_visible(const Place& a, const Place& b) const {
  return std::ranges::all_of(pairs_, [&](const Pair& pair) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    return is_way_free(pair.diagram, {a[i], a[j]}, {b[i], b[j]});
  });
}

/// The local time of arm k at a whole number of units.
double JointSearch::time_of(std::size_t arm, int units) const {
  const Pair& pair = *std::ranges::find_if(pairs_, [&](const Pair& p) {
    return static_cast<std::size_t>(p.i) == arm || static_cast<std::size_t>(p.j) == arm;
  });
  const bool is_x = static_cast<std::size_t>(pair.i) == arm;
  return is_x ? pair.diagram.at_x(units) : pair.diagram.at_y(units);
}

/// The way found without places that are not needed: from each to the furthest that is visible, by
/// doubling steps.
Schedule JointSearch::schedule() const {
  std::vector<Place> way = way_;
  for (Place& place : way) {
    for (std::size_t i = 0; i < place.size(); ++i) place[i] = std::min(units_[i], place[i] * size_);
  }
  std::vector<VectorXd> places;
  const auto add = [&](const Place& place) {
    VectorXd times(static_cast<Index>(place.size()));
    for (std::size_t i = 0; i < place.size(); ++i) {
      times[static_cast<Index>(i)] = time_of(i, place[i]);
    }
    places.push_back(std::move(times));
  };
  add(way.front());
  for (std::size_t at = 0; at + 1 < way.size();) {
    std::size_t next = at + 1;
    for (std::size_t step = 1; step > 0;) {
      if (next + step < way.size() && is_visible(way[at], way[next + step])) {
        next += step;
        step *= 2;
      } else {
        step /= 2;
      }
    }
    add(way[next]);
    at = next;
  }
  return make_schedule(places);
}

Result<Schedule> JointSearch::run() {
  const auto stopped = [&] {
    return std::unexpected(stop_.error("coordinating all arms at once"));
  };
  units_.resize(tracks_.size());
  for (const Pair& pair : pairs_) {
    units_[static_cast<std::size_t>(pair.i)] = pair.diagram.goal().x;
    units_[static_cast<std::size_t>(pair.j)] = pair.diagram.goal().y;
  }
  const double unit = options_.diagram.finest;
  while (2 * size_ * unit <= options_.search.coarse) size_ *= 2;
  for (;; size_ /= 2) {
    goal_.clear();
    for (const int units : units_) goal_.push_back((units + size_ - 1) / size_);
    grids_.clear();
    for (Pair& pair : pairs_) {
      if (!pair.diagram.resolve(size_, stop_)) return stopped();
      Raster raster(pair.diagram, size_, {});
      const bool monotone = options_.search.monotone;
      auto proven = raster.steps(Passage::kProven, false, monotone);
      auto possible = raster.steps(Passage::kPossible, false, monotone);
      grids_.push_back({std::move(raster), {std::move(proven), std::move(possible)}});
    }
    const Outcome proven = search(Passage::kProven);
    if (proven == Outcome::kFound) return schedule();
    const Outcome possible = proven == Outcome::kStopped ? proven : search(Passage::kPossible);
    if (possible == Outcome::kStopped) return stopped();
    if (possible == Outcome::kExhausted) {
      return fail(ErrorCode::kCoordination,
                  std::string("deadlock, proven: on these paths no timing brings all arms to their "
                              "goals") +
                      (options_.search.monotone ? " without going back" : ", not even going back") +
                      ". Every two of them could pass, all together cannot: " + blocking());
    }
    if (size_ == 1 || size_ / 2 * unit < options_.finest_step) break;
  }
  return fail(ErrorCode::kCoordination,
              "no timing was found that brings all arms to their goals, and no proof that there is "
              "none; near what blocks: " +
                  blocking());
}

/// A pair of links that touches where the arms' diagrams are blocked, for the message.
std::string JointSearch::blocking() const {
  for (const Pair& pair : pairs_) {
    for (const auto& c : pair.diagram.cells()) {
      if (c.state != CellState::kBlocked) continue;
      VectorXd place = VectorXd::Zero(static_cast<Index>(tracks_.size()));
      place[pair.i] = pair.diagram.at_x((c.x0 + c.x1) / 2);
      place[pair.j] = pair.diagram.at_y((c.y0 + c.y1) / 2);
      return describe_blocking(problem_.cell(), c.pair, place);
    }
  }
  return "nothing touches for certain, but too little is proven free";
}

}  // namespace

Result<Schedule> search_jointly(const CoordinationProblem& problem, const JointOptions& options,
                                const StopCondition& stop) {
  expects(problem.arms.size() > 1, "arms are coordinated from two on");
  expects(options.finest_step > 0 && options.most_nodes > 0, "limits of the search are positive");
  for (const world::BodyPair& pair : problem.cell().pairs()) {
    if (std::popcount(pair.moved_by) < 3) continue;
    return fail(ErrorCode::kUnsupported,
                "bodies that three arms move cannot be coordinated by pairs of arms: use the "
                "centralized strategy");
  }
  return JointSearch(problem, options, stop).run();
}

}  // namespace tandem::coordination
