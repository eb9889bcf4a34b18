// Machine code of Pinocchio and coal behind a plain C interface; documented in shim.h.

#include "shim.h"

#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <vector>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <coal/distance.h>
#include <coal/shape/geometric_shapes.h>

namespace {

using Vector = Eigen::VectorXd;
using Numbers = Eigen::Map<const Vector>;
// Type for which the library itself has the algorithms compiled.
using Given = Eigen::Ref<const Vector>;
using Place = Eigen::Map<const Eigen::Vector3d>;
using Rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

#define APIN_TEXT_OF(number) #number
#define APIN_NUMBER(number) APIN_TEXT_OF(number)

/// Base of evaluators: the text of the last error, and a virtual destructor.
struct Evaluator {
  char error[APIN_TEXT] = "";
  virtual ~Evaluator() = default;

  int64_t raised(const char *text) noexcept {
    std::strncpy(error, text, sizeof(error) - 1);
    error[sizeof(error) - 1] = '\0';
    return APIN_REFUSED;
  }

  /// Call a function; an exception ends here.
  template <class Function>
  int64_t guarded(const Function &function) noexcept {
    try {
      function();
      return APIN_ANSWERED;
    } catch (const std::exception &raised_inside) {
      return raised(raised_inside.what());
    } catch (...) {
      return raised("an exception without text");
    }
  }
};

struct Tree final : Evaluator {
  const pinocchio::Model &model;
  pinocchio::Data data;
  ApinTreeArrays at;

  Tree(const pinocchio::Model &model_, const ApinTreeArrays &arrays) : model(model_), data(model_), at(arrays) {}

  Numbers q() const { return Numbers(at.state, model.nq); }
  Numbers v() const { return Numbers(at.state + model.nq, model.nv); }
};

/// A pair with its transforms and result, which keep their memory.
struct Pair {
  ApinPair given;
  coal::Transform3s first, second;
  coal::DistanceResult result;

  explicit Pair(const ApinPair &pair) : given(pair) {}

  void answer() {
    if (given.first) first.setTranslation(Place(given.first));
    if (given.second) second.setTranslation(Place(given.second));
    if (given.turned == APIN_FIRST) first.setRotation(Rotation(given.turn));
    if (given.turned == APIN_SECOND) second.setRotation(Rotation(given.turn));
    if (given.turned == APIN_PLANE)
      *static_cast<coal::Halfspace *>(given.plane) = coal::Halfspace(Place(given.turn), given.turn[3]);
    result.clear();
    *given.distance = (*static_cast<const coal::ComputeDistance *>(given.functor))(
        first, second, *static_cast<const coal::DistanceRequest *>(given.request), result);
    for (int k = 0; k < 3; ++k) given.normal[k] = result.normal[k];
    if (given.point)
      for (int k = 0; k < 3; ++k) given.point[k] = result.nearest_points[0][k];
  }
};

struct Pairs final : Evaluator {
  std::vector<Pair, Eigen::aligned_allocator<Pair>> pairs;

  Pairs(const ApinPair *given, int64_t count) : pairs(given, given + count) {}
};

// Kept by the compiler, though nothing reads it: what the file was compiled of (shim.h).
__attribute__((used)) const char about[] =
    APIN_MARKER
    "{\"interface\": 1, \"pin\": \"" PINOCCHIO_VERSION "\", \"coal\": \"" COAL_VERSION "\", \"eigen\": \"" APIN_NUMBER(
        EIGEN_WORLD_VERSION) "." APIN_NUMBER(EIGEN_MAJOR_VERSION) "." APIN_NUMBER(EIGEN_MINOR_VERSION) "\", "
    "\"alignment\": " APIN_NUMBER(EIGEN_MAX_ALIGN_BYTES) ", \"source\": \"" APIN_SOURCE "\", \"compiler\": \"" __VERSION__
    "\"}\n";
static_assert(APIN_INTERFACE == 1, "the number stands in the text, too");

Tree *tree_of(void *evaluator) { return static_cast<Tree *>(static_cast<Evaluator *>(evaluator)); }

}  // namespace

extern "C" {

const char *apin_instruction_set(void) { return Eigen::SimdInstructionSetsInUse(); }

void *apin_tree(const void *model, const ApinTreeArrays *arrays) {
  try {
    return static_cast<Evaluator *>(new Tree(*static_cast<const pinocchio::Model *>(model), *arrays));
  } catch (...) {
    return nullptr;
  }
}

void apin_tree_sizes(const void *evaluator, int64_t *nq, int64_t *nv, double *gravity) {
  const Tree &tree = *tree_of(const_cast<void *>(evaluator));
  *nq = tree.model.nq;
  *nv = tree.model.nv;
  for (int k = 0; k < 6; ++k) gravity[k] = tree.model.gravity.toVector()[k];
}

int64_t apin_acceleration(double, void *evaluator) {
  Tree &tree = *tree_of(evaluator);
  return tree.guarded([&] {
    const Numbers effort(tree.at.effort, tree.model.nv);
    pinocchio::aba(tree.model, tree.data, Given(tree.q()), Given(tree.v()), Given(effort));
    std::memcpy(tree.at.acceleration, tree.data.ddq.data(), sizeof(double) * tree.model.nv);
  });
}

int64_t apin_terms(double, void *evaluator) {
  Tree &tree = *tree_of(evaluator);
  return tree.guarded([&] {
    const int nv = tree.model.nv;
    pinocchio::crba(tree.model, tree.data, Given(tree.q()));
    for (int i = 0; i < nv; ++i)
      for (int j = i; j < nv; ++j)
        tree.at.mass[i * nv + j] = tree.at.mass[j * nv + i] = tree.data.M(i, j);
    pinocchio::nonLinearEffects(tree.model, tree.data, Given(tree.q()), Given(tree.v()));
    std::memcpy(tree.at.bias, tree.data.nle.data(), sizeof(double) * nv);
  });
}

void *apin_pairs(const ApinPair *pairs, int64_t count) {
  try {
    return static_cast<Evaluator *>(new Pairs(pairs, count));
  } catch (...) {
    return nullptr;
  }
}

int64_t apin_distances(double, void *evaluator) {
  Pairs &all = *static_cast<Pairs *>(static_cast<Evaluator *>(evaluator));
  return all.guarded([&] {
    for (Pair &pair : all.pairs)
      if (*pair.given.asked >> pair.given.bit & 1) pair.answer();
  });
}

const char *apin_error(const void *evaluator) { return static_cast<const Evaluator *>(evaluator)->error; }

void apin_free(void *evaluator) { delete static_cast<Evaluator *>(evaluator); }

int64_t apin_fail(double, void *evaluator) {
  return static_cast<Evaluator *>(evaluator)->guarded([] { throw std::runtime_error("asked to fail"); });
}
}
