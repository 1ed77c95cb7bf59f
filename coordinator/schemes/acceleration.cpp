#include "coordinator/schemes/acceleration.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace tandem::launch {
namespace {

using Eigen::VectorXd;

// Number of earlier windows whose columns are kept: contacts open and close, and old responses mislead.
constexpr std::size_t reused_windows = 8;
// A column counts as new if this share of it remains after subtracting its projection on the newer ones.
constexpr double independent_share = 1e-3;

}  // namespace

std::unique_ptr<Accelerator> make_accelerator(const scene::Iteration& how) {
  switch (how.method) {
    case scene::Acceleration::constant:
      return std::make_unique<ConstantRelaxation>(how.relaxation);
    case scene::Acceleration::aitken:
      return std::make_unique<Aitken>(how.relaxation);
    case scene::Acceleration::iqn_ils:
      return std::make_unique<QuasiNewton>(how.relaxation);
  }
  return nullptr;
}

VectorXd ConstantRelaxation::next(const VectorXd& x, const VectorXd& image) {
  return x + factor_ * (image - x);
}

VectorXd Aitken::next(const VectorXd& x, const VectorXd& image) {
  const VectorXd residual = image - x;
  if (last_residual_.size() == residual.size()) {
    const VectorXd change = residual - last_residual_;
    if (change.squaredNorm() > 0) factor_ *= -last_residual_.dot(change) / change.squaredNorm();
  }
  last_residual_ = residual;
  return x + factor_ * residual;
}

void Aitken::save_or_restore(Archive& archive) {
  archive("acceleration/factor", factor_);
  archive.expect(std::isfinite(factor_), "acceleration/factor", "it is not finite");
}

VectorXd QuasiNewton::next(const VectorXd& x, const VectorXd& image) {
  const VectorXd residual = image - x;
  if (!columns_.empty() && columns_.front().residual.size() != x.size())
    throw Error(ErrorCode::resource, "the columns of earlier windows are those of another machine",
                "coupling.iteration", "continue from another checkpoint");
  if (last_x_.size() == x.size()) {
    columns_.push_front({residual - last_residual_, x - last_x_});
    ++own_;
    // Contacts have opened or closed: the columns of earlier windows are wrong now.
    if (residual.norm() > last_residual_.norm()) {
      columns_.resize(own_);
      counts_.clear();
    }
  }
  last_x_ = x;
  last_residual_ = residual;

  // Modified Gram-Schmidt on the residual differences; each orthogonal direction carries the corresponding
  // change of the iterate, so that the coefficients are never formed.
  struct Direction {
    VectorXd residual, iterate;
  };
  std::vector<Direction> directions;
  VectorXd unexplained = residual, step = VectorXd::Zero(x.size());
  for (const Column& column : columns_) {
    if (static_cast<Eigen::Index>(directions.size()) == x.size()) break;
    Direction d{column.residual, column.iterate};
    const double length = d.residual.norm();
    if (length == 0) continue;
    for (const Direction& known : directions) {
      const double share = known.residual.dot(d.residual);
      d.residual -= share * known.residual;
      d.iterate -= share * known.iterate;
    }
    const double left = d.residual.norm();
    if (left < independent_share * length) continue;
    d.residual /= left;
    d.iterate /= left;
    const double share = d.residual.dot(unexplained);
    unexplained -= share * d.residual;
    step -= share * d.iterate;
    directions.push_back(std::move(d));
  }
  if (expected_.rows() == x.size()) return x + step + expected_ * unexplained;
  return x + step + relaxation_ * unexplained;
}

void QuasiNewton::end_window() {
  last_x_.resize(0);
  counts_.push_front(own_);
  own_ = 0;
  while (counts_.size() > reused_windows) {
    columns_.resize(columns_.size() - counts_.back());
    counts_.pop_back();
  }
}

void QuasiNewton::save_or_restore(Archive& archive) {
  std::vector<std::uint64_t> counts(counts_.begin(), counts_.end());
  archive("acceleration/counts", counts);
  std::uint64_t columns = columns_.size();
  archive("acceleration/columns", columns);
  std::uint64_t counted = 0;
  for (const std::uint64_t count : counts) {
    archive.expect(count <= columns, "acceleration/counts", "a window has more columns than there are");
    counted += count;
  }
  archive.expect(counts.size() <= reused_windows && counted <= columns, "acceleration/counts",
                 "windows have more columns than there are");
  counts_.assign(counts.begin(), counts.end());
  if (archive.reads()) columns_.clear();
  for (std::uint64_t i = 0; i < columns; ++i) {
    if (archive.reads()) columns_.emplace_back();
    Column& column = columns_[i];
    archive("acceleration/residual." + std::to_string(i), column.residual);
    archive("acceleration/iterate." + std::to_string(i), column.iterate);
    archive.expect(column.residual.size() == columns_.front().residual.size() &&
                       column.iterate.size() == column.residual.size() && column.residual.allFinite() &&
                       column.iterate.allFinite(),
                   "acceleration/residual." + std::to_string(i),
                   "its length is another one, or a value is not finite");
  }
}

}  // namespace tandem::launch
