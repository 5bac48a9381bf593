#include "tandem/server/server.h"

#include <fstream>

#include "live_server.h"
#include "tandem/collision/ssv_checker.h"
#include "tandem/core/rng.h"
#include "test_data.h"

namespace tandem::server {
namespace {

using test::json;
using test::RawClient;
using test::status_of;

class ServerTest : public test::LiveServer {
 protected:
  Eigen::VectorXd start_of(const std::string& query) const {
    return pipeline::resolve(cell_, cell_->query(query))->start;
  }

  json ik_request(const std::string& arm, const Eigen::VectorXd& q, const Eigen::Isometry3d& X) {
    const Eigen::Quaterniond u(X.linear());
    const Eigen::Vector3d p = X.translation();
    return {
        {"arm", arm},
        {"q", list_of(q)},
        {"pose", {{"xyz", {p.x(), p.y(), p.z()}}, {"quat_wxyz", {u.w(), u.x(), u.y(), u.z()}}}}};
  }

  Eigen::Isometry3d tool_pose(int arm, const Eigen::VectorXd& q) const {
    Eigen::VectorXd positions;
    robot::LinkPoses X_WL;
    cell_->forward_kinematics(q, positions, X_WL);
    return cell_->tool_pose(arm, X_WL);
  }
};

TEST_F(ServerTest, ServesThePageAndWhatItShows) {
  start([](ServerOptions&, PageData& data) {
    data.plan = R"({"a":1})";
    data.clearance = "[2]";
  });
  EXPECT_EQ(server_->address(), "http://127.0.0.1:" + std::to_string(server_->port()) + "/");
  const auto page = client().Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->body, test::kPage);
  EXPECT_EQ(page->get_header_value("Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(page->get_header_value("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(page->get_header_value("Access-Control-Allow-Origin"), "");
  EXPECT_EQ(get("/api/scene"), json::parse(describe_scene(*cell_).json));
  EXPECT_EQ(get("/api/plan"), json({{"a", 1}}));
  EXPECT_EQ(get("/api/clearance"), json({2}));
  const auto icon = client().Get("/favicon.ico");
  ASSERT_TRUE(icon);
  EXPECT_EQ(icon->status, 204);
}

TEST_F(ServerTest, WithoutAPlanThereIsNull) {
  start();
  EXPECT_TRUE(get("/api/plan").is_null());
  EXPECT_TRUE(get("/api/clearance").is_null());
}

TEST_F(ServerTest, ServesTheMeshesOfTheSceneAndNothingElse) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("tandem-mesh-test" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const std::string bytes("solid\0\xff\r\n", 9);
  std::ofstream(folder / "a.STL", std::ios::binary) << bytes;
  start([&](ServerOptions&, PageData& data) {
    data.scene.meshes = {folder / "a.STL", folder / "gone.dae"};
  });
  const auto mesh = client().Get("/mesh/0");
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->body, bytes);
  EXPECT_EQ(mesh->get_header_value("Content-Type"), "model/stl");
  const json gone = get("/mesh/1", 404);
  EXPECT_NE(gone["error"]["message"].get<std::string>().find("gone.dae"), std::string::npos);
  for (const char* path :
       {"/mesh/2", "/mesh/-1", "/mesh/0x0", "/mesh/ 0", "/mesh/00000000000000000000000", "/mesh/",
        "/mesh/0/", "/mesh/99999999999999999999", "/mesh/0/../1", "/mesh/%2e%2e/0",
        "/mesh/a.STL"}) {
    const auto response = client().Get(path);
    ASSERT_TRUE(response) << path;
    EXPECT_TRUE(response->status == 404 || response->body == bytes) << path << response->status;
    EXPECT_EQ(response->body.find("root:"), std::string::npos);
  }
  std::filesystem::remove_all(folder);
}

TEST_F(ServerTest, UnknownPathsAreNotFoundHoweverTheyAreWritten) {
  start();
  for (const char* path :
       {"/index.html", "/api", "/api/", "/api/scene/", "//api/scene", "/../etc/passwd",
        "/../../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/..%2f..%2fetc/passwd",
        "/mesh/../../etc/passwd", "/mesh/..%2f..%2fetc%2fpasswd", "/etc/passwd", "/API/SCENE",
        "/api/capture", "/\\..\\etc", "/%00", "/mesh/%00"}) {
    RawClient raw(server_->port());
    raw.send(std::string("GET ") + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const std::string answer = raw.receive();
    EXPECT_EQ(status_of(answer), 404) << path << "\n" << answer;
    EXPECT_EQ(answer.find("root:"), std::string::npos) << path;
  }
}

TEST_F(ServerTest, OtherMethodsAreRefused) {
  start();
  for (const char* path : {"/", "/api/scene", "/api/plan", "/api/ik", "/api/query?name=cross"}) {
    for (const char* method : {"PUT", "DELETE", "PATCH", "OPTIONS", "HEAD"}) {
      RawClient raw(server_->port());
      raw.send(std::string(method) + " " + path +
               " HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n");
      EXPECT_EQ(status_of(raw.receive()), 405) << method << " " << path;
    }
  }
  EXPECT_EQ(get("/api/ik", 405)["error"]["code"], "method_not_allowed");
  EXPECT_EQ(post("/api/scene", "{}", 405)["error"]["code"], "method_not_allowed");
  const auto response = client().Get("/api/ik");
  ASSERT_TRUE(response);
  EXPECT_EQ(response->get_header_value("Allow"), "POST");
}

TEST_F(ServerTest, OnlyThisMachinesNamesAndItsOwnPageAreServed) {
  start();
  const std::string port = ":" + std::to_string(server_->port());
  const auto status = [&](const std::string& headers) {
    RawClient raw(server_->port());
    raw.send("GET /api/scene HTTP/1.1\r\n" + headers + "\r\n");
    return status_of(raw.receive());
  };
  for (const char* host : {"localhost", "127.0.0.1", "[::1]"}) {
    EXPECT_EQ(status("Host: " + std::string(host) + "\r\n"), 200) << host;
    EXPECT_EQ(status("Host: " + std::string(host) + port + "\r\n"), 200) << host;
  }
  for (const char* host :
       {"evil.example", "localhost.evil.example", "127.0.0.1.evil.example", "evil.example:80",
        "localhost@evil.example", "", "[::1].evil.example", "127.0.0.2", "0.0.0.0", "::1"}) {
    EXPECT_EQ(status("Host: " + std::string(host) + "\r\n"), 403) << host;
    EXPECT_EQ(status("Host: " + std::string(host) + port + "\r\n"), 403) << host;
  }
  EXPECT_EQ(status(""), 403);
  EXPECT_EQ(status("Host: localhost\r\nHost: evil.example\r\n"), 403);
  EXPECT_EQ(status("Host: localhost" + port + "\r\nOrigin: http://localhost" + port + "\r\n"), 200);
  for (const char* origin : {"http://evil.example", "null", "http://localhost:1"}) {
    EXPECT_EQ(status("Host: localhost" + port + "\r\nOrigin: " + origin + "\r\n"), 403) << origin;
  }
}

TEST_F(ServerTest, WithAHostOfItsOwnEveryNameIsServed) {
  start([](ServerOptions& options, PageData&) {
    options.host = "0.0.0.0";
    options.loopback_only = false;
  });
  RawClient raw(server_->port());
  raw.send("GET /api/scene HTTP/1.1\r\nHost: robot.lab\r\n\r\n");
  EXPECT_EQ(status_of(raw.receive()), 200);
}

TEST_F(ServerTest, QueriesHaveTheirEnds) {
  start();
  for (const char* name : {"cross", "back"}) {
    const auto ends = *pipeline::resolve(cell_, cell_->query(name));
    for (int round = 0; round < 2; ++round) {
      const json answer = get(std::string("/api/query?name=") + name);
      EXPECT_EQ(answer["start"], json(list_of(ends.start)));
      EXPECT_EQ(answer["goal"], json(list_of(ends.goal)));
    }
  }
  const std::string unknown = get("/api/query?name=cros", 404)["error"]["message"];
  EXPECT_NE(unknown.find("did you mean 'cross'?"), std::string::npos) << unknown;
  EXPECT_EQ(get("/api/query", 400)["error"]["message"], "parameter name is missing");
}

TEST_F(ServerTest, PlansAQueryAsTheLibraryDoes) {
  start();
  const json answer = post(
      "/api/plan",
      R"({"query":"cross","seed":3,"preset":"default","strategy":"centralized","deadline":20})");
  ASSERT_FALSE(answer.contains("error")) << answer;
  const auto plan = pipeline::plan(cell_, cell_->query("cross"), {.seed = 3, .deadline = 20.0});
  ASSERT_TRUE(plan) << plan.error().message;
  const json expected = json::parse(*io::plan_json(*plan, *cell_, "plan.json"));
  for (const char* key : {"arms", "start", "goal", "query", "seed", "options", "schema_version"}) {
    EXPECT_EQ(answer["plan"][key], expected[key]) << key;
  }
  ASSERT_GT(answer["clearance"].size(), 2U);
  for (const json& sample : answer["clearance"]) EXPECT_GT(sample["distance"], 0.0);
}

TEST_F(ServerTest, PlansBetweenGivenEnds) {
  start();
  const auto ends = *pipeline::resolve(cell_, cell_->query("cross"));
  const json request = {{"start", list_of(ends.goal)}, {"goal", list_of(ends.start)}};
  const json answer = post("/api/plan", request.dump());
  ASSERT_FALSE(answer.contains("error")) << answer;
  EXPECT_EQ(answer["plan"]["start"], request["start"]);
  EXPECT_EQ(answer["plan"]["goal"], request["goal"]);
  EXPECT_EQ(answer["plan"]["query"], "live");
}

// What a query carries is a body of its motion only, whatever the scene shows.
TEST_F(ServerTest, QueriesAndPlansComeWithTheObjectsThatTheyMove) {
  auto spec = test::small_cell_spec();
  const auto pose = [](double x, double y, double z) {
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.translation() = Eigen::Vector3d(x, y, z);
    return X;
  };
  const Eigen::Isometry3d X_WO = pose(0, -0.7, 0.1);
  spec.obstacles.push_back({"part", {*geometry::Shape::box(X_WO, {0.03, 0.03, 0.03})}});
  spec.obstacles.back().X_WO = X_WO;
  world::Attach grip;
  grip.object = "part";
  grip.arm = "left";
  grip.pose = pose(0.05, 0, 0);
  spec.queries[1].changes.attach = {grip};
  const auto at_rest = *world::Workcell::make(spec);
  const auto carrying = pipeline::resolve(at_rest, at_rest->query("back"))->cell;
  const auto body_in = [](const std::shared_ptr<const world::Workcell>& cell) {
    const json scene = json::parse(describe_scene(*cell).json);
    for (const json& body : scene["bodies"]) {
      if (body["name"] == "part") return json::array({body});
    }
    return json();
  };
  EXPECT_EQ(body_in(carrying)[0]["kind"], "attached");
  EXPECT_EQ(body_in(at_rest)[0]["kind"], "obstacle");

  cell_ = at_rest;
  start();
  EXPECT_EQ(get("/api/query?name=cross")["objects"], json::array());
  EXPECT_EQ(get("/api/query?name=back")["objects"], body_in(carrying));
  EXPECT_EQ(post("/api/plan", R"({"query":"back"})")["objects"], body_in(carrying));
  cell_ = carrying;
  start();
  EXPECT_EQ(get("/api/query?name=cross")["objects"], body_in(at_rest));
  EXPECT_EQ(get("/api/query?name=back")["objects"], body_in(carrying));
  EXPECT_EQ(post("/api/plan", R"({"query":"cross"})")["objects"], body_in(at_rest));
}

TEST_F(ServerTest, AGoalThatTouchesIsAnAnswerThatNamesThePairs) {
  start();
  const Eigen::VectorXd q = start_of("cross");
  Eigen::VectorXd bad = q;
  bad[1] = bad[5] = 1.4;  // Both arms into the table.
  const json answer =
      post("/api/plan", json({{"start", list_of(q)}, {"goal", list_of(bad)}}).dump());
  EXPECT_EQ(answer["error"]["code"], "infeasible");
  EXPECT_NE(answer["error"]["message"].get<std::string>().find("goal"), std::string::npos);
  const collision::SsvChecker checker(cell_);
  const auto scratch = checker.make_scratch();
  std::vector<collision::PairClearance> touching;
  checker.clearances(bad, cell_->select(world::PairScope::all()), 1e-300, *scratch, touching);
  ASSERT_GE(touching.size(), 2U);
  ASSERT_EQ(answer["error"]["touching"].size(), touching.size());
  for (std::size_t i = 0; i < touching.size(); ++i) {
    const json& pair = answer["error"]["touching"][i];
    EXPECT_EQ(pair["end"], "goal");
    EXPECT_EQ(pair["pair"], cell_->describe_pair(touching[i].pair));
    EXPECT_NEAR(pair["distance"].get<double>(), touching[i].distance, 1e-12);
    EXPECT_LE(pair["distance"].get<double>(), 0.0);
    EXPECT_EQ(pair["a"].size(), 3U);
    EXPECT_EQ(pair["b"].size(), 3U);
  }
}

TEST_F(ServerTest, EveryPairThatTouchesSaysAtWhichEnd) {
  start();
  const Eigen::VectorXd q = start_of("cross");
  Eigen::VectorXd bad = q, worse = q;
  bad[1] = worse[1] = worse[5] = 1.4;  // One arm into the table, both arms.
  const auto ends_of = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
    const json request = {{"start", list_of(from)}, {"goal", list_of(to)}};
    std::map<std::string, int> ends;
    std::string last;
    const json answer = post("/api/plan", request.dump());
    for (const json& pair : answer["error"]["touching"]) {
      EXPECT_FALSE(last == "goal" && pair["end"] == "start");
      last = pair["end"];
      ++ends[last];
    }
    return ends;
  };
  const auto at_start = ends_of(bad, q), at_both = ends_of(bad, worse);
  ASSERT_EQ(at_start.size(), 1U);
  ASSERT_EQ(at_both.size(), 2U);
  EXPECT_EQ(at_both.at("start"), at_start.at("start"));
  EXPECT_GT(at_both.at("goal"), at_both.at("start"));
}

TEST_F(ServerTest, AJointOutsideItsLimitIsNamed) {
  start();
  const Eigen::VectorXd q = start_of("cross");
  Eigen::VectorXd outside = q;
  outside[6] = 2.75;
  const json answer =
      post("/api/plan", json({{"start", list_of(q)}, {"goal", list_of(outside)}}).dump());
  const std::string message = answer["error"]["message"];
  EXPECT_NE(message.find("right/joint3"), std::string::npos) << message;
  EXPECT_NE(message.find("2.75"), std::string::npos) << message;
}

TEST_F(ServerTest, InverseKinematicsStaysNearAndLeavesTheOtherArmAlone) {
  start();
  Rng rng(11);
  for (int round = 0; round < 20; ++round) {
    const Eigen::VectorXd q = start_of("cross");
    const int arm = round % 2;
    // The small arm's tool turns with it: a pose that it reaches is one of another q.
    Eigen::VectorXd there = q;
    for (int j = 0; j < 4; ++j) there[4 * arm + j] += rng.uniform(-0.1, 0.1);
    const Eigen::Isometry3d X_WE = tool_pose(arm, there);
    const json answer = post("/api/ik", ik_request(arm == 0 ? "left" : "right", q, X_WE).dump());
    ASSERT_FALSE(answer.contains("error")) << answer;
    const auto values = answer["q"].get<std::vector<double>>();
    const Eigen::VectorXd found = Eigen::Map<const Eigen::VectorXd>(values.data(), 8);
    EXPECT_LT((tool_pose(arm, found).matrix() - X_WE.matrix()).norm(), 1e-5);
    EXPECT_EQ(found.segment(4 - 4 * arm, 4), q.segment(4 - 4 * arm, 4));
    EXPECT_LT((found - there).norm(), 1e-3);
  }
}

TEST_F(ServerTest, InverseKinematicsShowsWhatTouches) {
  start();
  const Eigen::VectorXd q = start_of("cross");
  Eigen::VectorXd low = q;
  low[1] = 0.6;
  const json answer = post("/api/ik", ik_request("left", low, tool_pose(0, low)).dump());
  ASSERT_FALSE(answer.contains("error")) << answer;
  ASSERT_FALSE(answer["touching"].empty());
  bool with_table = false;
  for (const json& pair : answer["touching"]) {
    EXPECT_LE(pair["distance"].get<double>(), 0.0);
    with_table = with_table || pair["pair"].get<std::string>().find("table") != std::string::npos;
  }
  EXPECT_TRUE(with_table);
  EXPECT_TRUE(post("/api/ik", ik_request("left", q, tool_pose(0, q)).dump())["touching"].empty());
}

TEST_F(ServerTest, APoseOutOfReachIsAnAnswer) {
  start();
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation() = Eigen::Vector3d(30, 0, 0);
  const json answer = post("/api/ik", ik_request("left", start_of("cross"), far).dump());
  EXPECT_EQ(answer["error"]["code"], "infeasible") << answer;
  const json unknown = post("/api/ik", ik_request("lefd", start_of("cross"), far).dump(), 404);
  EXPECT_NE(unknown["error"]["message"].get<std::string>().find("'left'"), std::string::npos);
}

}  // namespace
}  // namespace tandem::server
