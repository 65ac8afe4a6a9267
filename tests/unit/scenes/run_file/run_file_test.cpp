#include "brink/scenes/run_file/run_file.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <fstream>
#include <set>

#include "brink/core/shapes/shapes.h"
#include "brink/core/world/world_hash.h"
#include "brink/scenes/run_file/shape_json.h"

namespace brink::run_file_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Open = RunFileRecorder::Open;

std::shared_ptr<const Outline> outline(Shape shape) {
  return std::make_shared<const Outline>(centered(std::move(shape)).outline);
}

Scene two_bodies() {
  Scene scene;
  scene.path = "two.toml";
  scene.world.title = "two bodies";
  Body disc;
  disc.name = "disc";
  disc.outline = outline(make_disc(0.1));
  disc.mass = 0.1;  // not a binary fraction: a written and read text would show
  Body box;
  box.name = "box";
  box.outline = outline(make_box(1.0, 0.3, 0.05));
  box.initial.pose.position = {1.0 / 3.0, 2.0};
  scene.world.bodies = {disc, box};
  FixedSite floor;
  floor.name = "floor";
  floor.kind = "segment";
  floor.outline = std::make_shared<const Outline>(make_segment({-1, 0}, {1, 0}).outline);
  floor.pose = {{0.0, -1.0}, 0.0};
  scene.world.sites = {floor};
  scene.options_json = R"({"solver":{"policy":"global_backup","step":0.001}})";
  return scene;
}

std::vector<BodyState> states_at_time(double t) {
  return {{{{t, t / 3}, 10 * t}, {{1, 1.0 / 3}, 10}}, {{{-t, 0.1}, 0}, {{-1, 0}, 0}}};
}

Event event(std::uint64_t seq, double t) {
  Event e;
  e.seq = seq;
  e.contact.time = t;
  e.contact.body = 1;
  e.contact.other_body = seq % 2 == 0 ? 0 : -1;
  e.contact.other_site = seq % 2 == 0 ? -1 : 0;
  e.contact.site = 2;
  e.contact.sample = 3;
  e.contact.sample_on_body = false;
  e.contact.time_low = 1e-17;
  e.contact.point = {t, 0.1};
  e.contact.normal = {0.6, 0.8};
  e.contact.closing_speed = t / 7;
  e.contact.gap = 1e-17;
  e.impulse_n = 1.0 / 3;
  e.impulse_t = -2.0 / 3;
  return e;
}

std::vector<std::byte> blob(unsigned char fill, std::size_t size = 100) { return {size, std::byte{fill}}; }

RunSummary finished(double end) {
  RunSummary summary;
  summary.termination = Termination::reached_end;
  summary.end_time = end;
  summary.state_hash = 0x1234;
  summary.work.collisions = 7;
  return summary;
}

std::vector<double> event_times(const fs::path& file) {
  std::vector<double> times;
  for (const Event& e : RunFile(file).events()) times.push_back(e.contact.time);
  return times;
}

std::int64_t frame_rows(const fs::path& file) {
  SQLite::Database db(file.string());
  return db.execAndGet("SELECT count(*) FROM frame").getInt64();
}

std::string integrity(const fs::path& file) {
  SQLite::Database db(file.string());
  return db.execAndGet("PRAGMA integrity_check").getString();
}

class RunFileTest : public ::testing::Test {
 protected:
  RunFileTest() {
    std::string name = (fs::temp_directory_path() / "brink-run-file-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
  }
  ~RunFileTest() override { fs::remove_all(dir_); }
  fs::path file() const { return dir_ / "run.db"; }

  fs::path dir_;
  Scene scene_ = two_bodies();
};

// An index costs a microsecond a row, which who stops a long run would wait for.
TEST_F(RunFileTest, ALongRunThatIsStoppedIsNotIndexedBeforeItsEnd) {
  const auto indices = [&](int frames, Termination termination) {
    RunFileRecorder recorder(dir_, scene_, Open::fresh);
    const auto states = states_at_time(0.0);
    for (int k = 0; k < frames; ++k) recorder.frame(0.1 * k, states);
    RunSummary summary = finished(0.1 * frames);
    summary.termination = termination;
    recorder.finish(summary, "{}");
    return SQLite::Database(file().string())
        .execAndGet("SELECT count(*) FROM sqlite_master WHERE type = 'index' AND sql IS NOT NULL")
        .getInt();
  };
  const int all = indices(3, Termination::reached_end);
  EXPECT_GE(all, 5);
  EXPECT_EQ(indices(3, Termination::stopped), all);
  EXPECT_EQ(indices(100'001, Termination::stopped), 0);  // of two bodies
  EXPECT_EQ(RunFile(file()).frame_count(), 100'001);
  EXPECT_EQ(indices(100'001, Termination::reached_end), all);
}

// Doubles go in and out of SQLite as 8-byte IEEE values, so equality is exact.
TEST_F(RunFileTest, FramesAndEventsReadBackToTheSameBits) {
  RunFileRecorder recorder(dir_, scene_, Open::fresh);
  recorder.frame(0.1, states_at_time(0.1));
  recorder.event(event(0, 0.15));
  recorder.event(event(1, 0.17));
  recorder.finish(finished(0.1), "{}");
  const RunFile run(file());
  const RunFile::Frame frame = run.frame_at(0.1);
  const auto wanted = states_at_time(0.1);
  ASSERT_EQ(frame.states.size(), 2u);
  EXPECT_EQ(frame.t, 0.1);
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(frame.states[k].pose.position, wanted[k].pose.position);
    EXPECT_EQ(frame.states[k].pose.angle, wanted[k].pose.angle);
    EXPECT_EQ(frame.states[k].twist.velocity, wanted[k].twist.velocity);
    EXPECT_EQ(frame.states[k].twist.omega, wanted[k].twist.omega);
  }
  const auto events = run.events();
  ASSERT_EQ(events.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    const Event e = event(i, i == 0 ? 0.15 : 0.17);
    EXPECT_EQ(events[i].seq, e.seq);
    EXPECT_EQ(events[i].kind, e.kind);
    EXPECT_EQ(events[i].contact.time, e.contact.time);
    EXPECT_EQ(events[i].contact.time_low, e.contact.time_low);
    EXPECT_EQ(events[i].contact.body, e.contact.body);
    EXPECT_EQ(events[i].contact.other_body, e.contact.other_body);
    EXPECT_EQ(events[i].contact.other_site, e.contact.other_site);
    EXPECT_EQ(events[i].contact.site, e.contact.site);
    EXPECT_EQ(events[i].contact.sample, e.contact.sample);
    EXPECT_EQ(events[i].contact.sample_on_body, e.contact.sample_on_body);
    EXPECT_EQ(events[i].contact.point, e.contact.point);
    EXPECT_EQ(events[i].contact.normal, e.contact.normal);
    EXPECT_EQ(events[i].contact.closing_speed, e.contact.closing_speed);
    EXPECT_EQ(events[i].contact.gap, e.contact.gap);
    EXPECT_EQ(events[i].impulse_n, e.impulse_n);
    EXPECT_EQ(events[i].impulse_t, e.impulse_t);
  }
}

// The columns that other programs read: the contract's names, in the contract's order (more may follow).
TEST_F(RunFileTest, TablesHaveTheContractsColumns) {
  RunFileRecorder(dir_, scene_, Open::fresh).finish(finished(1), "{}");
  const std::map<std::string, std::string> contract = {
      {"meta", "key,value"},
      {"body", "id,name,mass,inertia,shape"},
      {"site", "id,name,owner,kind,shape"},
      {"frame", "t,body,x,y,angle,vx,vy,omega"},
      {"event", "seq,t,kind,body,other,site,px,py,nx,ny,closing_speed,impulse_n,impulse_t,gap"},
      {"contact", "t_begin,t_end,body,other,site,outline_site,sample,mode,force_n,force_t"},
      {"work", "counter,value,unit"},
      {"checkpoint", "t,state"}};
  SQLite::Database db(file().string());
  for (const auto& [table, columns] : contract) {
    std::string found;
    SQLite::Statement get(db, "SELECT name FROM pragma_table_info('" + table + "') ORDER BY cid");
    while (get.executeStep()) found += (found.empty() ? "" : ",") + get.getColumn(0).getString();
    EXPECT_EQ(found.substr(0, columns.size()), columns) << table;
  }
}

TEST_F(RunFileTest, EventWithAFixedSiteHasNullOtherAndTheSitesId) {
  {
    RunFileRecorder recorder(dir_, scene_, Open::fresh);
    recorder.event(event(0, 0.1));  // even: with body 0
    recorder.event(event(1, 0.2));  // odd: with the floor, site 0
  }
  SQLite::Database db(file().string());
  EXPECT_EQ(db.execAndGet("SELECT other FROM event WHERE seq = 0").getInt(), 0);
  EXPECT_TRUE(db.execAndGet("SELECT site IS NULL FROM event WHERE seq = 0").getInt());
  EXPECT_TRUE(db.execAndGet("SELECT other IS NULL FROM event WHERE seq = 1").getInt());
  EXPECT_EQ(db.execAndGet("SELECT site.name FROM event JOIN site ON site.id = event.site WHERE seq = 1")
                .getString(),
            "floor");
}

TEST_F(RunFileTest, FinishWritesTheEndingAndLeavesOneFile) {
  RunFileRecorder recorder(dir_, scene_, Open::fresh);
  EXPECT_EQ(RunFile(file()).meta("termination"), "running");
  RunSummary summary = finished(2.5);
  summary.termination = Termination::failed;
  summary.why = "no step left";
  recorder.finish(summary, R"({"x":1})");
  const auto meta = RunFile(file()).meta();
  EXPECT_EQ(meta.at("termination"), "failed: no step left");
  EXPECT_EQ(meta.at("end_time"), "2.5");
  EXPECT_EQ(meta.at("state_hash"), "0000000000001234");
  EXPECT_EQ(meta.at("summary"), R"({"x":1})");
  EXPECT_EQ(meta.at("title"), "two bodies");
  SQLite::Database db(file().string());
  EXPECT_EQ(db.execAndGet("SELECT value FROM work WHERE counter = 'collisions'").getDouble(), 7.0);
  EXPECT_FALSE(fs::exists(file().string() + "-wal"));
}

TEST_F(RunFileTest, ResumeDropsExactlyTheRowsAfterTheCheckpoint) {
  {
    RunFileRecorder recorder(dir_, scene_, Open::fresh);
    recorder.frame(0.0, states_at_time(0.0));
    recorder.event(event(0, 0.1));
    recorder.event(event(1, 0.2));
    recorder.frame(0.2, states_at_time(0.2));
    recorder.checkpoint(0.2, blob(1));
    recorder.event(event(2, 0.2));  // the same time as the checkpoint, but after it
    recorder.frame(0.3, states_at_time(0.3));
  }
  RunFileRecorder recorder(dir_, scene_, Open::resume);
  ASSERT_TRUE(recorder.resume_point());
  EXPECT_EQ(recorder.resume_point()->t, 0.2);
  EXPECT_EQ(recorder.resume_point()->state, blob(1));
  EXPECT_THAT(event_times(file()), ElementsAre(0.1, 0.2));
  EXPECT_EQ(frame_rows(file()), 4);
  recorder.event(event(2, 0.25));
  recorder.frame(0.4, states_at_time(0.4));
  recorder.finish(finished(0.4), "{}");
  EXPECT_THAT(event_times(file()), ElementsAre(0.1, 0.2, 0.25));
  EXPECT_EQ(RunFile(file()).time_range(), std::pair(0.0, 0.4));
  EXPECT_EQ(frame_rows(file()), 6);
}

LastedContact lasted(double from, double to, bool with_site) {
  return {from,
          to,
          ContactMode::roll,
          1,
          with_site ? -1 : 0,
          with_site ? 0 : -1,
          3,
          0,
          false,
          {from, 0.1},
          {0.6, 0.8},
          1.0 / 3,
          -2.0 / 7};
}

TEST_F(RunFileTest, ContactsReadBackToTheSameBitsAtTheirTimes) {
  RunFileRecorder recorder(dir_, scene_, Open::fresh);
  recorder.contact_lasted(lasted(0.1, 0.3, false));
  recorder.contact_lasted(lasted(0.3, 0.5, true));
  recorder.contact_lasted(lasted(0.2, 0.5, true));
  recorder.checkpoint(0.5, blob(1));
  recorder.finish(finished(0.5), "{}");
  const RunFile run(file());
  const auto from_at = [&](double t) {
    std::vector<double> times;
    for (const LastedContact& c : run.contacts_at(t)) times.push_back(c.from);
    return times;
  };
  EXPECT_THAT(from_at(0.05), ElementsAre());
  EXPECT_THAT(from_at(0.1), ElementsAre(0.1));
  EXPECT_THAT(from_at(0.25), ElementsAre(0.1, 0.2));
  EXPECT_THAT(from_at(0.3), ElementsAre(0.3, 0.2));  // a stretch ends where the next begins
  EXPECT_THAT(from_at(0.5), ElementsAre(0.3, 0.2));  // at the end of the run they last still
  const LastedContact c = run.contacts_at(0.1)[0], wanted = lasted(0.1, 0.3, false);
  EXPECT_EQ(c.to, wanted.to);
  EXPECT_EQ(c.mode, wanted.mode);
  EXPECT_EQ(c.body, wanted.body);
  EXPECT_EQ(c.other_body, wanted.other_body);
  EXPECT_EQ(c.other_site, wanted.other_site);
  EXPECT_EQ(c.sample, wanted.sample);
  EXPECT_EQ(c.site, wanted.site);
  EXPECT_EQ(c.sample_on_body, wanted.sample_on_body);
  EXPECT_EQ(c.point, wanted.point);
  EXPECT_EQ(c.normal, wanted.normal);
  EXPECT_EQ(c.normal_force, wanted.normal_force);
  EXPECT_EQ(c.tangential_force, wanted.tangential_force);
  EXPECT_EQ(run.contacts_at(0.5)[0].other_site, 0);
}

// Contacts that last at the end of a run come after its checkpoint: going on, they are told again, whole.
TEST_F(RunFileTest, ResumeDropsContactsAfterTheCheckpoint) {
  {
    RunFileRecorder recorder(dir_, scene_, Open::fresh);
    recorder.contact_lasted(lasted(0.1, 0.2, true));
    recorder.checkpoint(0.3, blob(1));
    recorder.contact_lasted(lasted(0.2, 0.3, true));
    recorder.finish(finished(0.3), "{}");
  }
  RunFileRecorder recorder(dir_, scene_, Open::resume);
  EXPECT_EQ(recorder.resume_point()->contacts, 1);
  recorder.contact_lasted(lasted(0.2, 0.4, true));
  recorder.finish(finished(0.4), "{}");
  SQLite::Database db(file().string());
  EXPECT_EQ(db.execAndGet("SELECT count(*) FROM contact").getInt(), 2);
  EXPECT_EQ(RunFile(file()).contacts_at(0.25).at(0).to, 0.4);
}

// A run stopped at t = 0.013 with frames every 0.01 s has a frame there, which a run that never stopped has
// not.
TEST_F(RunFileTest, ResumeDropsTheFrameOfAnEarlyEndOnly) {
  scene_.output.frame_interval = 0.01;
  for (const double stop : {0.013, 0.02}) {
    {
      RunFileRecorder recorder(dir_, scene_, Open::fresh);
      for (const double t : {0.0, 0.01, stop}) recorder.frame(t, states_at_time(t));
      recorder.checkpoint(stop, blob(1));
    }
    const RunFileRecorder recorder(dir_, scene_, Open::resume);
    EXPECT_EQ(RunFile(file()).time_range().second, stop == 0.02 ? 0.02 : 0.01);
  }
}

// Stopped at 0.013, gone on with, killed before the next checkpoint: the frame of the early end was dropped
// when the run went on, so the checkpoint must not count it any more, or a frame after it would stay and be
// made again.
TEST_F(RunFileTest, KilledAfterGoingOnKeepsNoRowAfterTheCheckpoint) {
  scene_.output.frame_interval = 0.01;
  {
    RunFileRecorder recorder(dir_, scene_, Open::fresh);
    for (const double t : {0.0, 0.01, 0.013}) recorder.frame(t, states_at_time(t));
    recorder.checkpoint(0.013, blob(1));
  }
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    RunFileRecorder recorder(dir_, scene_, Open::resume);
    recorder.frame(0.02, states_at_time(0.02));
    ::usleep(300'000);  // longer than rows may wait
    recorder.poll();
    ::raise(SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_EQ(RunFile(file()).time_range().second, 0.02);
  const RunFileRecorder recorder(dir_, scene_, Open::resume);
  ASSERT_TRUE(recorder.resume_point());
  EXPECT_EQ(recorder.resume_point()->state, blob(1));
  EXPECT_EQ(RunFile(file()).time_range().second, 0.01);
  EXPECT_EQ(frame_rows(file()), 4);
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::set<std::string> names_in(const fs::path& dir) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(dir)) names.insert(entry.path().filename());
  return names;
}

// Any change of the checkpoint's row is seen, and named; the file stays byte for byte as it was, and alone.
TEST_F(RunFileTest, DamagedCheckpointIsRefusedAndNothingIsTouched) {
  const char* const damages[] = {
      "UPDATE checkpoint SET state = zeroblob(100)",
      "UPDATE checkpoint SET state = substr(state, 1, length(state) - 1)",
      "UPDATE checkpoint SET state = substr(state, 1, 40) || x'07' || substr(state, 42)",
      "UPDATE checkpoint SET state = substr(state, 1, 7)",
      "UPDATE checkpoint SET state = NULL",
      "UPDATE checkpoint SET t = 0.3",
      "UPDATE checkpoint SET frames = 2",
      "UPDATE checkpoint SET events = -1",
      "UPDATE checkpoint SET wall_seconds = 'long'",
      "INSERT INTO checkpoint SELECT * FROM checkpoint"};
  for (const char* damage : damages) {
    {
      RunFileRecorder recorder(dir_, scene_, Open::fresh);
      recorder.frame(0.0, states_at_time(0.0));
      recorder.frame(0.2, states_at_time(0.2));
      recorder.checkpoint(0.2, blob(1));
      recorder.finish(finished(0.2), "{}");
    }
    SQLite::Database(file().string(), SQLite::OPEN_READWRITE).exec(damage);
    const std::string before = bytes_of(file());
    const auto beside = names_in(dir_);
    try {
      RunFileRecorder(dir_, scene_, Open::resume);
      FAIL() << damage;
    } catch (const IoError& e) {
      EXPECT_THAT(e.what(), HasSubstr(file().string() + ": table checkpoint: ")) << damage;
    }
    EXPECT_TRUE(bytes_of(file()) == before) << damage;
    EXPECT_EQ(names_in(dir_), beside) << damage;
  }
}

// Also where the file was last left in write-ahead mode, as by a run whose file somebody else was reading.
TEST_F(RunFileTest, RefusedResumeLeavesNoLogBeside) {
  RunFileRecorder(dir_, scene_, Open::fresh).finish(finished(1), "{}");
  SQLite::Database(file().string(), SQLite::OPEN_READWRITE).exec("PRAGMA journal_mode = WAL");
  const std::string before = bytes_of(file());
  const auto beside = names_in(dir_);
  scene_.world.bodies[0].mass *= 2.0;
  EXPECT_THROW(RunFileRecorder(dir_, scene_, Open::resume), BadInput);
  EXPECT_TRUE(bytes_of(file()) == before);
  EXPECT_EQ(names_in(dir_), beside);
}

TEST_F(RunFileTest, RowsThatTheCheckpointCountsMustBeThere) {
  {
    RunFileRecorder recorder(dir_, scene_, Open::fresh);
    recorder.frame(0.0, states_at_time(0.0));
    recorder.event(event(0, 0.1));
    recorder.event(event(1, 0.1));
    recorder.checkpoint(0.2, blob(1));
    recorder.finish(finished(0.2), "{}");
  }
  SQLite::Database(file().string(), SQLite::OPEN_READWRITE).exec("DELETE FROM event WHERE seq = 0");
  EXPECT_THROW(RunFileRecorder(dir_, scene_, Open::resume), IoError);
}

// A database of somebody else that happens to be called run.db.
TEST_F(RunFileTest, AnotherProgramsDatabaseIsRefusedAndLeftAlone) {
  SQLite::Database(file().string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE)
      .exec("CREATE TABLE bookmarks (url)");
  const std::string before = bytes_of(file());
  EXPECT_THROW(RunFileRecorder(dir_, scene_, Open::resume), IoError);
  EXPECT_TRUE(bytes_of(file()) == before);
}

// Rows that a picture would read past the end of, ids that are nobody's, numbers that are none.
TEST_F(RunFileTest, DamagedTablesAreAnIoErrorThatNamesThem) {
  const std::map<std::string, std::string> damages = {
      {"DELETE FROM frame WHERE rowid = 3", "frame"},
      {"UPDATE frame SET x = NULL WHERE rowid = 3", "frame"},
      {"UPDATE frame SET body = 7 WHERE rowid = 3", "frame"},
      {"UPDATE frame SET t = 'soon' WHERE rowid = 3", "frame"},
      {"DELETE FROM body WHERE id = 0", "body"},
      {"UPDATE body SET shape = '{' WHERE id = 0", "body"},
      {"UPDATE body SET shape = replace(shape, '0.1', '1e308') WHERE id = 0", "body"},
      {"UPDATE site SET shape = NULL", "site"},
      {"UPDATE event SET body = 2", "event"},
      {"UPDATE event SET kind = 'miracle'", "event"},
      {"UPDATE contact SET mode = 'hover'", "contact"},
      {"UPDATE contact SET body = 2", "contact"},
      {"UPDATE contact SET site = NULL", "contact"},
      {"UPDATE contact SET other = 0", "contact"},
      {"UPDATE contact SET force_n = 'much'", "contact"},
      {"UPDATE meta SET value = '{\"world\":{\"periodic\":[\"a\"]}}' WHERE key = 'options'", "meta"},
      {"UPDATE meta SET value = 'late' WHERE key = 'end_time'", "meta"},
      {"INSERT OR REPLACE INTO meta VALUES ('springs', "
       "'[{\"body\":null,\"other\":null,\"at\":[0,0],\"other_at\":[0,0],"
       "\"stiffness\":1,\"rest_length\":1}]')",
       "meta"},
      {"DROP TABLE site", "site"}};
  for (const auto& [damage, table] : damages) {
    {
      RunFileRecorder recorder(dir_, scene_, Open::fresh);
      recorder.frame(0.0, states_at_time(0.0));
      recorder.frame(0.2, states_at_time(0.2));
      recorder.event(event(0, 0.1));
      recorder.contact_lasted(lasted(0.1, 0.2, true));
      recorder.finish(finished(0.2), "{}");
    }
    SQLite::Database(file().string(), SQLite::OPEN_READWRITE).exec(damage);
    try {
      const RunFile run(file());
      run.world();
      run.events();
      run.states_at(0.1);
      run.contacts_at(0.1);
      run.end_time();
      ADD_FAILURE() << damage;
    } catch (const IoError& e) {
      EXPECT_THAT(e.what(), HasSubstr(file().string())) << damage;
      EXPECT_THAT(e.what(), HasSubstr(fmt::format("table {}", table))) << damage;
    }
  }
}

// SQLite as Debian builds it takes names that begin with "file:" for URIs.
TEST_F(RunFileTest, FolderCalledLikeAUriIsAFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(dir_);
  RunFileRecorder("file:x?mode=memory", scene_, Open::fresh).finish(finished(1), "{}");
  EXPECT_EQ(RunFile("file:x?mode=memory/run.db").meta("end_time"), "1");
  EXPECT_TRUE(fs::exists(dir_ / "file:x?mode=memory/run.db"));
  fs::current_path(before);
}

TEST_F(RunFileTest, ResumeWithoutCheckpointStartsFromNothing) {
  {
    RunFileRecorder recorder(dir_, scene_, Open::fresh);
    recorder.frame(0.0, states_at_time(0.0));
    recorder.event(event(0, 0.1));
  }
  const RunFileRecorder recorder(dir_, scene_, Open::resume);
  EXPECT_FALSE(recorder.resume_point());
  EXPECT_EQ(frame_rows(file()), 0);
  EXPECT_THAT(event_times(file()), ElementsAre());
}

TEST_F(RunFileTest, ResumeWithOtherOptionsNamesTheOption) {
  RunFileRecorder(dir_, scene_, Open::fresh).finish(finished(1), "{}");
  scene_.options_json = R"({"solver":{"policy":"global_backup","step":0.002}})";
  try {
    RunFileRecorder(dir_, scene_, Open::resume);
    FAIL() << "other options were accepted";
  } catch (const BadInput& e) {
    EXPECT_THAT(e.what(), HasSubstr("/solver/step was 0.001, is now 0.002"));
    EXPECT_THAT(e.what(), ::testing::Not(HasSubstr("policy")));
  }
}

TEST_F(RunFileTest, ResumeWithAnotherWorldIsRefused) {
  RunFileRecorder(dir_, scene_, Open::fresh).finish(finished(1), "{}");
  scene_.world.bodies[0].mass = std::nextafter(scene_.world.bodies[0].mass, 1.0);
  EXPECT_THROW(RunFileRecorder(dir_, scene_, Open::resume), BadInput);
  EXPECT_EQ(RunFile(file()).meta("termination"), "reached_end");  // and nothing was touched
}

TEST_F(RunFileTest, FreshRunKeepsTheEarlierFile) {
  RunFileRecorder(dir_, scene_, Open::fresh).finish(finished(1), "{}");
  RunFileRecorder(dir_, scene_, Open::fresh).finish(finished(2), "{}");
  EXPECT_EQ(RunFile(dir_ / "run-1.db").meta("end_time"), "1");
  EXPECT_EQ(RunFile(file()).meta("end_time"), "2");
}

TEST_F(RunFileTest, SecondRunInTheSameFolderIsRefused) {
  const RunFileRecorder recorder(dir_, scene_, Open::fresh);
  EXPECT_THROW(RunFileRecorder(dir_, scene_, Open::fresh), IoError);
  EXPECT_EQ(integrity(file()), "ok");
}

TEST_F(RunFileTest, FileThatIsNoDatabaseIsAnIoError) {
  std::ofstream(file()) << std::string(5000, 'x');
  EXPECT_THROW(RunFile{file()}, IoError);
  EXPECT_THROW(RunFileRecorder(dir_, scene_, Open::resume), IoError);
  EXPECT_THROW(RunFile{dir_ / "absent.db"}, IoError);
}

// A child records events, with a checkpoint in the middle, and kills itself with signal 9 while rows wait in
// a transaction. What was committed with the checkpoint must be there; the file must be sound.
TEST_F(RunFileTest, KilledWriterLeavesAWholeFileUpToItsCheckpoint) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    RunFileRecorder recorder(dir_, scene_, Open::fresh);
    for (int i = 0; i < 1000; ++i) recorder.event(event(i, i));
    recorder.checkpoint(1000, blob(2, 1 << 20));
    for (int i = 1000; i < 1500; ++i) recorder.event(event(i, i));
    ::raise(SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(integrity(file()), "ok");
  EXPECT_GE(event_times(file()).size(), 1000u);
  EXPECT_EQ(RunFile(file()).meta("termination"), "running");
  const RunFileRecorder recorder(dir_, scene_, Open::resume);
  ASSERT_TRUE(recorder.resume_point());
  EXPECT_EQ(recorder.resume_point()->state, blob(2, 1 << 20));
  EXPECT_EQ(event_times(file()).size(), 1000u);
}

// Before the file has a log, and when it is given up for one plain file, SQLite keeps a journal: who is killed then leaves
// half a transaction, which only a writer can take back.
TEST_F(RunFileTest, KilledBesideAJournalItOpensAllTheSame) {
  RunFileRecorder(dir_, scene_, Open::fresh).finish(finished(1), "{}");
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    SQLite::Database db(file().string(), SQLite::OPEN_READWRITE);
    db.exec("PRAGMA cache_size = 1");  // pages go to disk before the commit
    db.exec("BEGIN IMMEDIATE");
    db.exec("UPDATE meta SET value = 'torn'");
    db.exec("INSERT INTO meta VALUES ('more', zeroblob(1000000))");
    ::raise(SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_TRUE(fs::exists(file().string() + "-journal"));
  EXPECT_EQ(RunFile(file()).meta("termination"), "reached_end");
  EXPECT_FALSE(fs::exists(file().string() + "-journal"));
  EXPECT_NO_THROW(RunFileRecorder(dir_, scene_, Open::resume));
}

// Where rows are rare, poll() alone must bring them to disk: another process then sees them.
TEST_F(RunFileTest, PollCommitsWhatHasWaited) {
  RunFileRecorder recorder(dir_, scene_, Open::fresh);
  recorder.event(event(0, 0.1));
  ::usleep(300'000);  // longer than the 0.25 s that rows may wait
  recorder.poll();
  EXPECT_THAT(event_times(file()), ElementsAre(0.1));
}

// A cubic through two points with given slopes is exact for a parabola: between the frames at 0 and 1 of
// x = 2 t - 4.9 t^2 the picture at t = 0.3 must show it to rounding.
TEST_F(RunFileTest, StatesBetweenFramesOfAParabolaAreOnIt) {
  const auto parabola = [](double t) {
    return std::vector<BodyState>(2, {{{2 * t - 4.9 * t * t, 0}, 3 * t}, {{2 - 9.8 * t, 0}, 3}});
  };
  RunFileRecorder recorder(dir_, scene_, Open::fresh);
  recorder.frame(0, parabola(0));
  recorder.frame(1, parabola(1));
  recorder.finish(finished(1), "{}");
  const RunFile run(file());
  const RunFile::Frame frame = run.states_at(0.3);
  EXPECT_EQ(frame.t, 0.3);
  EXPECT_NEAR(frame.states[1].pose.position.x(), 2 * 0.3 - 4.9 * 0.09, 1e-15);
  EXPECT_NEAR(frame.states[1].twist.velocity.x(), 2 - 9.8 * 0.3, 1e-14);
  EXPECT_NEAR(frame.states[1].pose.angle, 0.9, 1e-15);
  EXPECT_EQ(run.states_at(7).t, 1.0);  // beyond the end: the last frame
  EXPECT_EQ(run.frame_at(0.99).t, 0.0);
}

TEST_F(RunFileTest, BodiesAndSitesReadBackWithTheirShapes) {
  RunFileRecorder(dir_, scene_, Open::fresh).finish(finished(1), "{}");
  const RunFile run(file());
  const auto bodies = run.bodies();
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_EQ(bodies[0].mass, 0.1);
  EXPECT_EQ(bodies[1].name, "box");
  const Outline& box = *scene_.world.bodies[1].outline;
  ASSERT_EQ(bodies[1].outline.sites.size(), box.sites.size());
  for (std::size_t i = 0; i < box.sites.size(); ++i) {
    EXPECT_EQ(bodies[1].outline.sites[i].a, box.sites[i].a);
    EXPECT_EQ(bodies[1].outline.sites[i].kind, box.sites[i].kind);
    EXPECT_EQ(bodies[1].outline.sites[i].arc_radius, box.sites[i].arc_radius);
  }
  EXPECT_EQ(bodies[1].outline.solid, box.solid);
  ASSERT_EQ(run.sites().size(), 1u);
  EXPECT_EQ(run.sites()[0].kind, "segment");
  EXPECT_EQ(run.sites()[0].outline->sites[0].a,
            Vec2(-1, -1));  // given at (-1, 0), the site is shifted by (0, -1)
}

TEST(ShapeJson, ArcsAndRadiiReadBackToTheSameOutline) {
  for (const Shape& shape : {make_disc(0.1), make_capsule(1, 0.2), make_box(1, 2, 0.1),
                             make_disc_container(3), make_path("M 0 0 C 1 0 1 1 0 1 Z", 1.0 / 3, 1e-3)}) {
    const std::string text = outline_to_json(shape.outline);
    EXPECT_EQ(outline_to_json(outline_from_json(text)), text);
  }
}

// A site that moves is kept about its own frame; back in the world it is where it was, to rounding.
TEST(ShapeJson, MovingSiteReadsBackWithItsPoseAndMotion) {
  FixedSite site;
  site.outline = std::make_shared<const Outline>(make_segment({-1, 0}, {1, 0.5}).outline);
  site.pose = {{3, 4}, 0.7};
  site.motion = FormulaMotion{Formula("0.1*sin(6*t)", {"t"}), {}, Formula("t", {"t"})};
  const FixedSite read = fixed_site_from_json(fixed_site_to_json(site));
  EXPECT_EQ(read.pose.position, site.pose.position);
  EXPECT_EQ(read.pose.angle, site.pose.angle);
  EXPECT_LT((read.outline->sites[0].b - Vec2(1, 0.5)).norm(), 1e-15);
  const auto& motion = std::get<FormulaMotion>(read.motion);
  EXPECT_EQ(motion.x->text(), "0.1*sin(6*t)");
  const double t[] = {2.0};
  EXPECT_EQ((*motion.y)(t), 0.0);
  EXPECT_EQ((*motion.angle)(t), 2.0);
}

TEST(ShapeJson, WrongTextIsBadInput) {
  for (const char* text : {"", "{}", "[1,2]", R"({"solid":true,"container":false,"loops":[{"closed":1}]})"}) {
    EXPECT_THROW(outline_from_json(text), BadInput) << text;
  }
}

// Every part of a world that moves a body must move the hash; names must not.
TEST(WorldHash, ChangesWithEveryPartButNames) {
  const Scene scene = two_bodies();
  std::set<std::uint64_t> seen{world_hash(scene.world)};
  const auto is_new = [&](auto change) {
    World world = scene.world;
    change(world);
    return seen.insert(world_hash(world)).second;
  };
  EXPECT_TRUE(is_new([](World& w) { w.gravity.y() = -1; }));
  EXPECT_TRUE(is_new([](World& w) { w.bodies[1].inertia = 2; }));
  EXPECT_TRUE(is_new([](World& w) { w.bodies[1].initial.twist.omega = 1; }));
  EXPECT_TRUE(is_new([](World& w) { w.bodies[1].lock_x = true; }));
  EXPECT_TRUE(is_new([](World& w) { w.bodies[0].outline = outline(make_disc(0.2)); }));
  EXPECT_TRUE(is_new([](World& w) { w.materials[0].friction = 0.5; }));
  EXPECT_TRUE(is_new([](World& w) { w.sites[0].motion = ConstantMotion{}; }));
  EXPECT_TRUE(is_new([](World& w) { w.sites[0].motion = FormulaMotion{Formula("sin(t)", {"t"}), {}, {}}; }));
  EXPECT_TRUE(is_new([](World& w) { w.sites[0].motion = FormulaMotion{{}, Formula("sin(t)", {"t"}), {}}; }));
  EXPECT_TRUE(is_new([](World& w) { w.forces.push_back(DragForce{{0}, 1, 0, 0}); }));
  EXPECT_TRUE(is_new([](World& w) { w.forces.push_back(DragForce{{0}, 0, 1, 0}); }));
  constexpr std::uint64_t held = std::uint64_t{1} << 53;  // above, doubles do not tell all integers apart
  for (const std::uint64_t seed : {held, held + 1, held + 2, ~std::uint64_t{0}, ~std::uint64_t{1}})
    EXPECT_TRUE(is_new([&](World& w) { w.bodies[0].sampling.seed = seed; })) << seed;
  EXPECT_FALSE(is_new([](World& w) { w.bodies[0].name = "another"; }));
}

}  // namespace
}  // namespace brink::run_file_test
