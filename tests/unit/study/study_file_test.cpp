// Wrong study files: each message names the place, the fault, and the remedy.
#include "tests/unit/study/study_folder.hpp"

namespace tandem::launch {
namespace {

class StudyFile : public StudyFolderTest {
 protected:
  std::string refusal(const std::string& change) const {
    return message([&] { study(change); });
  }
};

TEST_F(StudyFile, IsRead) {
  const Study it = study(R"({"set": [{"of": "/mbd/bodies/0/mass", "value": 2}], "threads": 4, "repeat": 3})");
  EXPECT_EQ(it.sweep[0].at.to_string(), "/coupling/window");
  EXPECT_EQ(it.sweep[1].values.size(), 2u);
  EXPECT_EQ(it.set[0].at.to_string(), "/mbd/bodies/0/mass");
  EXPECT_EQ(it.threads, 4);
  EXPECT_EQ(it.repeat, 3);
  EXPECT_EQ(study().repeat, 1);
  EXPECT_EQ(it.scene, folder_ / "scene.json");
  EXPECT_EQ(it.measures[0].error, "largest");
}

TEST_F(StudyFile, Refusals) {
  EXPECT_EQ(refusal(R"({"sweeps": []})"), "study.json: unknown key 'sweeps' (did you mean 'sweep'?)");
  EXPECT_EQ(refusal(R"({"study": "2.0"})"),
            "study.json: study: the value is \"2.0\" (give \"1.0\": version of the study format)");
  EXPECT_EQ(refusal(R"({"sweep": []})"),
            "study.json: sweep: the list is empty (give at least 1 element: settings that are varied; every "
            "combination is "
            "run)");
  EXPECT_EQ(refusal(R"({"sweep": [{"of": "windw", "values": [1]}]})"),
            "study.json: sweep[0].of: there is no setting 'windw' (did you mean 'window'?; others are given "
            "by a JSON "
            "pointer such as /mbd/bodies/0/mass)");
  EXPECT_EQ(refusal(R"({"sweep": [{"of": "/a~2", "values": [1]}]})"),
            "study.json: sweep[0].of: '/a~2' is no JSON pointer (~ stands before 0 or 1 only)");
  EXPECT_EQ(
      refusal(R"({"sweep": [{"of": "window", "values": [1]}, {"of": "/coupling/window", "values": [2]}]})"),
      "study.json: sweep[1].of: '/coupling/window' is swept twice (put all values into one list)");
  EXPECT_EQ(refusal(R"({"sweep": [{"of": "window", "values": [1, 1]}]})"),
            "study.json: sweep[0].values[1]: the value 1 is given twice (keep one of them)");
  EXPECT_EQ(refusal(R"({"sweep": [{"of": "window", "values": [{}]}]})"),
            "study.json: sweep[0].values[0]: the value is an object (give a number or a text or true or "
            "false or a list of "
            "numbers: values in the scene)");
  EXPECT_EQ(refusal(R"({"order_in": "mbd_step"})"),
            "study.json: order_in: 'mbd_step' is not swept (known sweeps: window, rho_inf)");
  EXPECT_EQ(refusal(R"({"sweep": [{"of": "scheme", "values": ["mbd_first"]}], "order_in": "scheme"})"),
            "study.json: order_in: 'scheme' has the value \"mbd_first\" (an order is observed in a step "
            "size: a number > "
            "0)");
  EXPECT_EQ(
      refusal(R"({"reference": {"times": [0.5, 0.5], "signals": [{"of": "hinge.q", "values": [1, 2]}]}})"),
      "study.json: reference.times[1]: 0.5 s does not come after 0.5 s (times must increase)");
  EXPECT_EQ(refusal(R"({"reference": {"signals": [{"of": "hinge.q", "values": [1]}]}})"),
            "study.json: reference.signals[0].values: 1 values for 2 times (give one value for each time)");
  EXPECT_EQ(refusal(R"({"reference": {"type": "file"}})"),
            "study.json: reference.type: the value is \"file\" (known values: table, run, folder)");
  EXPECT_EQ(refusal(R"({"reference": null})"),
            "study.json: measures[0]: there is no reference to compare 'hinge.q' with (add reference)");
  EXPECT_EQ(refusal(R"({"measures": [{"name": "a", "of": ["hinge.rate"]}]})"),
            "study.json: measures[0].of: the table has no signal 'hinge.rate' (known signals: hinge.q)");
  EXPECT_EQ(
      refusal(R"({"measures": [{"name": "a", "of": ["summary.x"], "error": "rms"}]})"),
      "study.json: measures[0]: a number of summary.json has no course in time (leave out error and from)");
  EXPECT_EQ(refusal(R"({"measures": [{"name": "a", "of": ["hinge.q"], "expected": 1}]})"),
            "study.json: measures[0].expected: only a number of summary.json has one (signals are compared "
            "with the "
            "reference)");
  EXPECT_EQ(refusal(R"({"measures": [{"name": "a", "of": ["hinge.q"], "error": "period"}]})"),
            "study.json: measures[0].error: a table has no period of the whole signal (use largest, rms or "
            "last, or a "
            "reference of type run or folder)");
  EXPECT_EQ(refusal(R"({"measures": [{"name": "a", "of": ["hinge.q"]}, {"name": "a", "of": ["hinge.q"]}]})"),
            "study.json: measures[1].name: 'a' is already the name of a measure (give another name)");
  EXPECT_EQ(refusal(R"({"threads": 0})"),
            "study.json: threads: the value is 0 (give a number from 1 to 4096: of the particle solver of "
            "one run [-])");
}

}  // namespace
}  // namespace tandem::launch
