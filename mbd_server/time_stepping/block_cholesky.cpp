#include "mbd_server/time_stepping/block_cholesky.hpp"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

#include "common/error.hpp"
#include "mbd_server/time_stepping/as_index.hpp"

namespace tandem::mbd {

// A place is coupled to the later ones of its pairs, and to those of the places before it that have it as
// their first later one.
void BlockCholesky::plan(int rows) {
  place_of_.resize(as_index(rows));
  if (!pairs_.empty()) {
    std::vector<Eigen::Triplet<double>> blocks;
    for (int k = 0; k < rows; ++k) blocks.emplace_back(k, k, 1);
    for (const auto& [a, b] : pairs_) blocks.emplace_back(a, b, 1), blocks.emplace_back(b, a, 1);
    Eigen::SparseMatrix<double> pattern(rows, rows);
    pattern.setFromTriplets(blocks.begin(), blocks.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>()(pattern, order);  // the row at each place
    for (int k = 0; k < rows; ++k) place_of_[as_index(order.indices()[k])] = k;
  } else {
    for (int k = 0; k < rows; ++k) place_of_[as_index(k)] = k;
  }
  std::vector<std::vector<int>> later(as_index(rows));
  for (const auto& [a, b] : pairs_) {
    const auto [low, high] = std::minmax(place_of_[as_index(a)], place_of_[as_index(b)]);
    later[as_index(low)].push_back(high);
  }
  first_.assign(1, 0);
  later_.clear();
  products_ = 0;
  for (std::vector<int>& own : later) {
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    later_.insert(later_.end(), own.begin(), own.end());
    first_.push_back(static_cast<int>(later_.size()));
    products_ += own.size() * (own.size() + 1) / 2;
    if (own.size() > 1)
      later[as_index(own[0])].insert(later[as_index(own[0])].end(), own.begin() + 1, own.end());
  }
  entries_.clear();
  for (const auto& [a, b] : pairs_) {
    const int x = place_of_[as_index(a)], y = place_of_[as_index(b)], low = std::min(x, y),
              high = std::max(x, y);
    const auto found = std::lower_bound(later_.begin() + first_[as_index(low)],
                                        later_.begin() + first_[as_index(low) + 1], high);
    // The lower block has the later place as its row.
    entries_.push_back({static_cast<int>(found - later_.begin()), x < y});
  }
  diagonal_.resize(as_index(rows));
  lower_.resize(later_.size());
  right_.resize(as_index(rows));
}

void BlockCholesky::factorise(const BlockMatrix& A) {
  if (A.rows() != static_cast<int>(place_of_.size()) || A.pairs != pairs_) {
    pairs_ = A.pairs;
    plan(A.rows());
  }
  for (Matrix6d& block : lower_) block.setZero();
  for (std::size_t row = 0; row < place_of_.size(); ++row)
    diagonal_[as_index(place_of_[row])] = A.diagonal[row];
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    Matrix6d& block = lower_[as_index(entries_[k].lower)];
    if (entries_[k].transposed)
      block = A.upper[k].transpose();
    else
      block = A.upper[k];
  }
  for (std::size_t p = 0; p < diagonal_.size(); ++p) {
    const Eigen::LLT<Matrix6d> llt(diagonal_[p]);
    if (llt.info() != Eigen::Success)
      throw Error(ErrorCode::numerics, "the matrix of the contacts is not positive definite", "mbd_server",
                  "give the bodies mass and inertia, and the materials a smaller stiffness");
    diagonal_[p] = llt.matrixL();
    const int begin = first_[p], end = first_[p + 1];
    for (int e = begin; e < end; ++e)
      diagonal_[p].triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(
          lower_[as_index(e)]);
    for (int e = begin; e < end; ++e) {
      const std::size_t i = as_index(later_[as_index(e)]);
      const Matrix6d mirrored = lower_[as_index(e)].transpose();
      diagonal_[i].noalias() -= lower_[as_index(e)].lazyProduct(mirrored);
      int place = first_[i];
      for (int g = e + 1; g < end; ++g) {
        while (later_[as_index(place)] != later_[as_index(g)]) ++place;
        lower_[as_index(place)].noalias() -= lower_[as_index(g)].lazyProduct(mirrored);
      }
    }
  }
}

void BlockCholesky::solve(std::vector<Vector6d>& r) {
  for (std::size_t row = 0; row < r.size(); ++row) right_[as_index(place_of_[row])] = r[row];
  for (std::size_t p = 0; p < right_.size(); ++p) {
    diagonal_[p].triangularView<Eigen::Lower>().solveInPlace(right_[p]);
    for (int e = first_[p]; e < first_[p + 1]; ++e)
      right_[as_index(later_[as_index(e)])].noalias() -= lower_[as_index(e)].lazyProduct(right_[p]);
  }
  for (std::size_t p = right_.size(); p-- > 0;) {
    for (int e = first_[p]; e < first_[p + 1]; ++e)
      right_[p].noalias() -=
          lower_[as_index(e)].transpose().lazyProduct(right_[as_index(later_[as_index(e)])]);
    diagonal_[p].triangularView<Eigen::Lower>().transpose().solveInPlace(right_[p]);
  }
  for (std::size_t row = 0; row < r.size(); ++row) r[row] = right_[as_index(place_of_[row])];
}

}  // namespace tandem::mbd
