/// What a server must survive: requests that are malformed, huge, slow or many.

#include <gtest/gtest.h>

#include <atomic>

#include "live_server.h"
#include "tandem/server/requests.h"

namespace tandem::server {
namespace {

using test::json;
using test::RawClient;
using test::status_of;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

class BoundsTest : public test::LiveServer {
 protected:
  void expect_alive() const { EXPECT_EQ(get("/api/scene")["name"], "small"); }

  /// Walls on both sides of the left arm and a lid above it: it cannot get from its start to its
  /// goal, and a planner searches until it is stopped.
  void wall_in() {
    world::WorkcellSpec spec = test::small_cell_spec();
    const auto box = [&](const char* name, const Eigen::Vector3d& at, const Eigen::Vector3d& size) {
      Eigen::Isometry3d X_WO = Eigen::Isometry3d::Identity();
      X_WO.translation() = at;
      spec.obstacles.push_back({name, {*geometry::Shape::box(X_WO, size)}});
    };
    box("inner_wall", {-0.2, 0, 0.6}, {0.4, 0.02, 1.2});
    box("outer_wall", {-1.1, 0, 0.6}, {1.0, 0.02, 1.2});
    box("lid", {-0.5, 0, 0.4}, {0.3, 0.3, 0.02});
    auto cell = world::Workcell::make(std::move(spec));
    ASSERT_TRUE(cell) << cell.error().message;
    cell_ = *cell;
  }

  std::string http_plan(const std::string& body) const {
    return "POST /api/plan HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
           std::to_string(body.size()) + "\r\n\r\n" + body;
  }
};

TEST_F(BoundsTest, MalformedRequestsSayWhatIsWrong) {
  start();
  const std::string zeros = "[0,0,0,0,0,0,0,0]", seven = "[0,0,0,0,0,0,0]";
  const std::string unit = R"("quat_wxyz":[1,0,0,0])";
  const auto ik = [&](const std::string& pose) {
    return R"({"arm":"left","q":)" + zeros + R"(,"pose":)" + pose + "}";
  };
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {"/api/plan", "", "not JSON"},
      {"/api/plan", "{", "not JSON"},
      {"/api/plan", "{} x", "not JSON"},
      {"/api/plan", "\"\xff\"", "not JSON"},
      {"/api/plan", R"({"query":"cross","seed":1e999})", "not JSON"},
      {"/api/plan", "[]", "the request is a list of 0, expected an object"},
      {"/api/plan", "null", "the request is null, expected an object"},
      {"/api/plan", "3", "the request is 3, expected an object"},
      {"/api/plan", "{}", "key start is missing"},
      {"/api/plan", R"({"start":)" + zeros + "}", "key goal is missing"},
      {"/api/plan", R"({"query":3})", "query is 3, expected a text"},
      {"/api/plan", R"({"query":"cross","start":)" + zeros + "}", "unknown key \"start\""},
      {"/api/plan", R"({"query":"cross","sede":1})", "did you mean 'seed'?"},
      {"/api/plan", R"({"query":"cross","seed":-1})", "seed is -1, expected a whole number"},
      {"/api/plan", R"({"query":"cross","seed":1.5})", "seed is 1.5, expected a whole number"},
      {"/api/plan", R"({"query":"cross","preset":"papper"})",
       R"(preset is "papper", expected "default" or "paper")"},
      {"/api/plan", R"({"query":"cross","strategy":"apart"})",
       R"(strategy is "apart", expected "centralized", "decoupled" or "auto")"},
      {"/api/plan", R"({"query":"cross","deadline":0})", "deadline is 0, expected a number from"},
      {"/api/plan", R"({"query":"cross","deadline":"5"})", "deadline is \"5\", expected a number"},
      {"/api/plan", R"({"query":"cross","deadline":null})", "deadline is null"},
      {"/api/plan", R"({"start":)" + seven + R"(,"goal":)" + zeros + "}",
       "start is a list of 7, expected 8 numbers: one per joint of the cell"},
      {"/api/plan", R"({"start":)" + zeros + R"(,"goal":[0,0,0,0,0,0,0,"1"]})",
       "goal[7] is \"1\", expected a number"},
      {"/api/plan", R"({"start":)" + zeros + R"(,"goal":[0,0,0,0,0,0,0,1e300]})",
       "goal[7] is 1e+300"},
      {"/api/plan", R"({"start":)" + zeros + R"(,"goal":{}})", "goal is an object of 0"},
      {"/api/ik", "{}", "key arm is missing"},
      {"/api/ik", R"({"arm":"left","q":)" + zeros + "}", "key pose is missing"},
      {"/api/ik", R"({"arm":1,"q":)" + zeros + R"(,"pose":{"xyz":[0,0,0],)" + unit + "}}",
       "arm is 1, expected a text"},
      {"/api/ik", ik("[]"), "pose is a list of 0, expected an object"},
      {"/api/ik", ik(R"({"xyz":[0,0,0]})"), "key pose.quat_wxyz is missing"},
      {"/api/ik", ik(R"({"xyz":[0,0],)" + unit + "}"), "pose.xyz is a list of 2"},
      {"/api/ik", ik(R"({"xyz":[0,0,1e5],)" + unit + "}"), "pose.xyz[2] is 100000.0"},
      {"/api/ik", ik(R"({"xyz":[0,0,0],"quat_wxyz":[0,0,0,0]})"), "expected a unit quaternion"},
      {"/api/ik", ik(R"({"xyz":[0,0,0],"quat_wxyz":[1,1,0,0]})"), "its norm is 1.41"},
  };
  for (const auto& [path, body, words] : cases) {
    const json answer = post(path, body, 400);
    EXPECT_EQ(answer["error"]["code"], "invalid_input") << body;
    EXPECT_NE(answer["error"]["message"].get<std::string>().find(words), std::string::npos)
        << body << "\n"
        << answer;
  }
}

TEST_F(BoundsTest, DeeplyNestedAndManyKeyedDocumentsAreRefusedQuickly) {
  start();
  const auto begin = Clock::now();
  const std::size_t depth = 500'000;
  post("/api/plan", std::string(depth, '['), 400);
  post("/api/plan", std::string(depth, '[') + std::string(depth, ']'), 400);
  std::string keys = "{";
  for (int i = 0; i < 50'000; ++i) keys.append("\"k").append(std::to_string(i)).append("\":0,");
  post("/api/plan", keys + "\"z\":0}", 400);
  EXPECT_LT(seconds_since(begin), 10);
  expect_alive();
}

TEST_F(BoundsTest, HugeBodiesAreRefused) {
  start();
  const auto response =
      client().Post("/api/plan", std::string((std::size_t{1} << 20) + 1, ' '), "application/json");
  ASSERT_TRUE(response) << httplib::to_string(response.error());
  EXPECT_EQ(response->status, 413);
  EXPECT_TRUE(json::parse(response->body).contains("error"));
  // One that only says that it is huge, and one without end.
  RawClient boasting(server_->port());
  boasting.send(
      "POST /api/ik HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999999\r\n\r\n{");
  boasting.send(std::string(100'000, ' '));
  RawClient endless(server_->port());
  endless.send("POST /api/ik HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n");
  const std::string chunk = "10000\r\n" + std::string(0x10000, ' ') + "\r\n";
  const auto begin = Clock::now();
  while (seconds_since(begin) < 10 && endless.send(chunk)) continue;
  EXPECT_LT(seconds_since(begin), 5);
  expect_alive();
}

TEST_F(BoundsTest, AnEncodedBodyIsRefused) {
  start();
  RawClient raw(server_->port());
  raw.send(
      "POST /api/ik HTTP/1.1\r\nHost: localhost\r\nContent-Encoding: gzip\r\nContent-Length: "
      "2\r\n\r\n{}");
  EXPECT_EQ(status_of(raw.receive()), 415);
}

TEST_F(BoundsTest, HugeHeadsAreRefused) {
  start();
  const auto head = [&](const std::string& text) {
    RawClient raw(server_->port());
    raw.send(text);
    return status_of(raw.receive());
  };
  const std::string host = " HTTP/1.1\r\nHost: localhost\r\n";
  EXPECT_EQ(head("GET /api/query?name=" + std::string(9000, 'a') + host + "\r\n"), 414);
  EXPECT_NE(head("GET /" + std::string(4 << 20, 'a') + host + "\r\n"), 200);
  EXPECT_NE(head("GET /" + host + "X: " + std::string(4 << 20, 'a') + "\r\n\r\n"), 200);
  std::string many;
  for (int i = 0; i < 200'000; ++i) many.append("H").append(std::to_string(i)).append(": x\r\n");
  EXPECT_NE(head("GET /" + host + many + "\r\n"), 200);
  expect_alive();
}

TEST_F(BoundsTest, WhatIsNotHttpIsRefused) {
  start([](ServerOptions& options, PageData&) { options.reading = 0.5; });
  for (const std::string& text :
       {std::string("\r\n\r\n"), std::string("hello\r\n\r\n"), std::string("GET\r\n\r\n"),
        std::string("GET / HTTP/9.9\r\nHost: localhost\r\n\r\n"),
        std::string(100, '\0') + "\r\n\r\n",
        std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n"),
        std::string(
            "GET / HTTP/1.1\r\nHost: localhost\r\nRange: bytes=9999999999999999999999-\r\n\r\n"),
        std::string("POST /api/ik HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n"),
        std::string("POST /api/ik HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: "
                    "chunked\r\n\r\nzz\r\n{}\r\n0\r\n\r\n")}) {
    RawClient raw(server_->port());
    raw.send(text);
    const int status = status_of(raw.receive(15));
    EXPECT_TRUE(status == 0 || status >= 400) << status << ": " << text;
  }
  expect_alive();
}

TEST_F(BoundsTest, OverlappingRangesAreNotMultiplied) {
  start();
  std::string ranges = "bytes=0-";
  for (int i = 0; i < 1000; ++i) ranges += ",0-";
  const auto response = client().Get("/", {{"Range", ranges}});
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, 200);
  EXPECT_EQ(response->body, test::kPage);
}

TEST_F(BoundsTest, SlowClientsAreCutAndHoldNobodyUp) {
  start([](ServerOptions& options, PageData&) {
    options.threads = 4;
    options.reading = 1.5;
  });
  // Each sends a byte now and then, which would hold a thread for as long as it likes; and there
  // are more of them than threads.
  std::vector<std::unique_ptr<RawClient>> slow;
  for (int i = 0; i < 12; ++i) {
    slow.push_back(std::make_unique<RawClient>(server_->port()));
    ASSERT_TRUE(slow.back()->connected());
    slow.back()->send("POST /api/ik HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n{");
  }
  std::atomic<bool> done = false;
  std::thread trickle([&] {
    while (!done) {
      for (const auto& client : slow) client->send(" ");
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
  const auto begin = Clock::now();
  expect_alive();
  EXPECT_LT(seconds_since(begin), 5);
  RawClient& last = *slow.back();
  EXPECT_TRUE(last.closes_within(10));
  done = true;
  trickle.join();
}

TEST_F(BoundsTest, AClientThatDoesNotReadIsCut) {
  start([](ServerOptions& options, PageData& data) {
    options.writing = 0.5;
    data.plan = "\"" + std::string(std::size_t{64} << 20, 'x') + "\"";
  });
  RawClient raw(server_->port());
  raw.send("GET /api/plan HTTP/1.1\r\nHost: localhost\r\n\r\n");
  std::this_thread::sleep_for(std::chrono::seconds(2));
  EXPECT_LT(raw.receive(30).size(), std::size_t{64} << 20);
  expect_alive();
}

TEST_F(BoundsTest, ASecondPlanIsRefusedWhileOneIsMadeAndOthersAreServed) {
  std::atomic<bool> made = false, inside = false;
  start([&](ServerOptions& options, PageData&) {
    // The plan's text keeps the planner's place for as long as the test likes.
    options.plan_json = [&](const pipeline::Plan&) -> Result<std::string> {
      inside = true;
      while (!made) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      return "{}";
    };
  });
  json first;
  std::thread planner([&] { first = post("/api/plan", R"({"query":"cross","deadline":20})"); });
  while (!inside) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(post("/api/plan", R"({"query":"cross"})", 429)["error"]["code"], "busy");
  }
  expect_alive();
  post("/api/plan", "{}", 400);
  made = true;
  planner.join();
  EXPECT_TRUE(first.contains("plan")) << first;
  post("/api/plan", R"({"query":"cross","deadline":20})");
}

TEST_F(BoundsTest, ManyAtOnceGetOnePlanAndRefusals) {
  start();
  std::atomic<int> planned = 0, busy = 0, other = 0;
  std::vector<std::thread> clients;
  for (int i = 0; i < 12; ++i) {
    clients.emplace_back([&] {
      const auto response =
          client().Post("/api/plan", R"({"query":"cross","deadline":20})", "application/json");
      const int status = response ? response->status : 0;
      ++(status == 200 ? planned : status == 429 ? busy : other);
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_GE(planned, 1);
  EXPECT_EQ(other, 0);
  EXPECT_EQ(planned + busy, 12);
}

TEST_F(BoundsTest, APlannerThatFindsNothingIsAnAnswerAtTheDeadline) {
  wall_in();
  start();
  const auto begin = Clock::now();
  const json answer = post("/api/plan", R"({"query":"cross","deadline":0.5})");
  EXPECT_LT(seconds_since(begin), 10);
  EXPECT_EQ(answer["error"]["code"], "timeout") << answer;
  EXPECT_TRUE(answer["error"]["touching"].empty());
  expect_alive();
}

TEST_F(BoundsTest, PlanningEndsWhenItsClientHangsUp) {
  wall_in();
  start();
  {
    RawClient impatient(server_->port());
    impatient.send(http_plan(R"({"query":"cross","deadline":30})"));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    post("/api/plan", R"({"query":"cross"})", 429);
  }
  const auto begin = Clock::now();
  int status = 429;
  while (status == 429 && seconds_since(begin) < 10) {
    const auto response =
        client().Post("/api/plan", R"({"query":"cross","deadline":0.1})", "application/json");
    status = response ? response->status : 0;
  }
  EXPECT_EQ(status, 200);
  EXPECT_LT(seconds_since(begin), 5);
}

TEST_F(BoundsTest, StoppingEndsPlanning) {
  wall_in();
  start();
  RawClient client(server_->port());
  client.send(http_plan(R"({"query":"cross","deadline":30})"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto begin = Clock::now();
  server_.reset();
  EXPECT_LT(seconds_since(begin), 5);
}

TEST_F(BoundsTest, StoppingIsQuickWhateverIsGoingOn) {
  start();
  RawClient idle(server_->port()), half(server_->port());
  half.send("GET / HT");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto begin = Clock::now();
  server_.reset();
  EXPECT_LT(seconds_since(begin), 2);
  EXPECT_TRUE(idle.closes_within(2));
  EXPECT_TRUE(half.closes_within(2));
}

TEST_F(BoundsTest, APortInUseIsAnError) {
  start();
  const auto second = Server::start(
      cell_, {},
      {.port = server_->port(),
       .page = "x",
       .plan_json = [](const pipeline::Plan&) -> Result<std::string> { return "{}"; }});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kIo);
  EXPECT_NE(second.error().message.find("127.0.0.1:" + std::to_string(server_->port())),
            std::string::npos);
}

TEST(Requests, DeadlinesAreCapped) {
  for (const auto& [deadline, expected] : {std::pair{"7.5", 7.5}, {"31", 30.0}, {"1e5", 30.0}}) {
    const auto request =
        read_plan_request(std::string(R"({"query":"cross","deadline":)") + deadline + "}", 8);
    ASSERT_TRUE(request) << request.error().message;
    EXPECT_EQ(request->options.deadline, expected);
  }
}

}  // namespace
}  // namespace tandem::server
