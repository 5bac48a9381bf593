#include "tandem/io/diagram_file.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "tandem/io/plan_file.h"

namespace tandem::io {

using Json = nlohmann::ordered_json;
using coordination::CellState;
using coordination::DiagramDrawing;

namespace {

const char* name_of(CellState state) {
  switch (state) {
    case CellState::kUnknown:
      return "unknown";
    case CellState::kFree:
      return "free";
    case CellState::kBlocked:
      return "blocked";
    case CellState::kOpen:
      return "open";
  }
  return "unknown";
}

Json line_json(const coordination::DiagramLine& line, const world::Workcell& cell) {
  Json json = {{"name", line.name}, {"makespan", line.schedule.makespan()}, {"free", line.is_free}};
  json["times"] = line.schedule.times;
  json["places"] = Json::array();
  for (const auto& place : line.schedule.places) json["places"].push_back({place[0], place[1]});
  json["touching"] = nullptr;
  if (!line.is_free) {
    json["touching"] = {{"time", line.time}, {"place", {line.place[0], line.place[1]}}};
    json["touching"]["pair"] = line.pair < 0 ? Json() : Json(cell.describe_pair(line.pair));
    json["touching"]["depth"] = line.depth;
  }
  return json;
}

/// Shortest text that reads back as the same double.
void append(std::string& text, double value, char after) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, end.ptr);
  text += after;
}

/// Quoted as RFC 4180 asks for it.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

}  // namespace

std::string diagram_json(const DiagramDrawing& drawing, const world::Workcell& cell,
                         const std::string& query) {
  const auto& arms = cell.arms();
  Json json = {{"schema_version", 1},
               {"tandem_version", TANDEM_VERSION},
               {"workcell", cell.name()},
               {"query", query},
               {"arms",
                {arms[static_cast<std::size_t>(drawing.arm_x)].name,
                 arms[static_cast<std::size_t>(drawing.arm_y)].name}},
               {"durations", {drawing.duration_x, drawing.duration_y}},
               {"resolution", drawing.resolution},
               {"evaluations", drawing.evaluations}};
  json["lines"] = Json::array();
  for (const auto& line : drawing.lines) json["lines"].push_back(line_json(line, cell));
  json["pairs"] = Json::array();
  json["cells"] = Json::array();
  std::vector<int> named;  // Pairs by their place in the list.
  for (const auto& c : drawing.cells) {
    Json pair;
    if (c.pair >= 0) {
      const auto known = std::ranges::find(named, c.pair);
      pair = known - named.begin();
      if (known == named.end()) {
        named.push_back(c.pair);
        json["pairs"].push_back(cell.describe_pair(c.pair));
      }
    }
    json["cells"].push_back({c.x0, c.y0, c.x1, c.y1, name_of(c.state), std::move(pair)});
  }
  // Names come from files of any encoding; a figure is worth more than a broken letter in it.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string diagram_cells_csv(const DiagramDrawing& drawing, const world::Workcell& cell) {
  std::string text = "x0,y0,x1,y1,state,pair\n";
  for (const auto& c : drawing.cells) {
    for (const double value : {c.x0, c.y0, c.x1, c.y1}) append(text, value, ',');
    text.append(name_of(c.state)) += ',';
    if (c.pair >= 0) text += quoted(cell.describe_pair(c.pair));
    text += '\n';
  }
  return text;
}

std::string diagram_lines_csv(const DiagramDrawing& drawing) {
  std::string text = "line,time,x,y\n";
  for (const auto& line : drawing.lines) {
    for (std::size_t k = 0; k < line.schedule.places.size(); ++k) {
      text += line.name + ',';
      append(text, line.schedule.times[k], ',');
      append(text, line.schedule.places[k][0], ',');
      append(text, line.schedule.places[k][1], '\n');
    }
  }
  return text;
}

Result<void> save_diagram(const std::filesystem::path& file, const DiagramDrawing& drawing,
                          const world::Workcell& cell, const std::string& query, bool overwrite) {
  if (file.extension() != ".csv") {
    return write_file(file, diagram_json(drawing, cell, query), overwrite);
  }
  auto lines = file;
  lines.replace_extension(".lines.csv");
  for (const auto& name : {file, lines}) {
    if (auto writable = check_writable(name, overwrite); !writable) return writable;
  }
  if (auto written = write_file(file, diagram_cells_csv(drawing, cell), overwrite); !written) {
    return written;
  }
  return write_file(lines, diagram_lines_csv(drawing), overwrite);
}

}  // namespace tandem::io
