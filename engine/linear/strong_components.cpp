#include "linear/strong_components.hpp"

#include <algorithm>

namespace bramah {
namespace {

using Eigen::Index;

class Search {
 public:
  explicit Search(const Eigen::MatrixXd& A)
      : n_(A.rows()), number_(size(), -1), low_(size(), 0), next_(size(), 0), waiting_(size(), false) {
    successors_.resize(size());
    for (Index j = 0; j < n_; ++j) {
      for (Index i = 0; i < n_; ++i) {
        if (i != j && A(i, j) != 0.0) successors_[at(i)].push_back(j);
      }
    }
    for (Index i = 0; i < n_; ++i) {
      if (number_[at(i)] < 0) visit(i);
    }
    // Found last: what nothing else leads to.
    std::reverse(found_.begin(), found_.end());
  }
  std::vector<std::vector<Index>> take() { return std::move(found_); }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] std::size_t size() const { return at(n_); }

  void enter(Index i) {
    number_[at(i)] = low_[at(i)] = count_++;
    stack_.push_back(i);
    waiting_[at(i)] = true;
    path_.push_back(i);
  }

  /// Depth first, without recursion: chains of thousands of rows are usual.
  void visit(Index root) {
    enter(root);
    while (!path_.empty()) {
      const Index i = path_.back();
      if (next_[at(i)] < successors_[at(i)].size()) {
        const Index j = successors_[at(i)][next_[at(i)]++];
        if (number_[at(j)] < 0) {
          enter(j);
        } else if (waiting_[at(j)]) {
          low_[at(i)] = std::min(low_[at(i)], number_[at(j)]);
        }
        continue;
      }
      path_.pop_back();
      if (!path_.empty()) low_[at(path_.back())] = std::min(low_[at(path_.back())], low_[at(i)]);
      if (low_[at(i)] == number_[at(i)]) close(i);
    }
  }

  void close(Index root) {
    std::vector<Index> component;
    for (Index i = -1; i != root;) {
      i = stack_.back();
      stack_.pop_back();
      waiting_[at(i)] = false;
      component.push_back(i);
    }
    std::sort(component.begin(), component.end());
    found_.push_back(std::move(component));
  }

  Index n_, count_ = 0;
  std::vector<std::vector<Index>> successors_;
  std::vector<Index> number_, low_, stack_, path_;
  std::vector<std::size_t> next_;
  std::vector<bool> waiting_;
  std::vector<std::vector<Index>> found_;
};

}  // namespace

std::vector<std::vector<Eigen::Index>> strong_components(const Eigen::MatrixXd& A) { return Search(A).take(); }

}  // namespace bramah
