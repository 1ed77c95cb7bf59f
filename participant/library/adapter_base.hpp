// What the solvers of both roles have in common.
#pragma once

#include <memory>
#include <string>

#include "participant/library/scene_view.hpp"
#include "participant/library/table.hpp"
#include "protocol/participant/solver.hpp"

namespace tandem::participant {

// Calls the functions of a table that save, restore and report. `Interface` is protocol::MotionSolver or
// protocol::LoadSolver.
template <class Interface, class Table>
class AdapterBase : public Interface {
 public:
  std::uint64_t capabilities() const override { return table_.capabilities; }

  void save() override {
    expect_ok(table_.save(self_), "save");
    saved_ = now_;
  }
  void restore() override {
    expect_ok(table_.restore(self_), "restore");
    now_ = saved_;
  }
  void checkpoint(const protocol::Checkpoint& file) override {
    const tandem_state_file state{file.window, file.time.count, file.path.c_str()};
    expect_ok(table_.checkpoint(self_, &state), "checkpoint");
  }
  void resume(const protocol::Checkpoint& file) override {
    const tandem_state_file state{file.window, file.time.count, file.path.c_str()};
    expect_ok(table_.resume(self_, &state), "resume");
    now_ = file.time;
  }
  protocol::Report report() override {
    tandem_facts facts(role_);
    expect_ok(table_.report(self_, &facts), "report");
    return {facts.text()};
  }

 protected:
  AdapterBase(const Table& table, void* self, std::string program, protocol::Role role)
      : table_(copied(table)), self_(self), program_(std::move(program)), role_(role) {}

  Table table_;
  void* self_;
  std::string program_;
  protocol::Role role_;
  std::unique_ptr<SceneView> view_;
  Nanoseconds now_, saved_;
};

}  // namespace tandem::participant
