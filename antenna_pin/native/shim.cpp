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

/// Joints for which forward dynamics are compiled here.
template <class... Joints>
struct Compiled {
  static bool takes(const pinocchio::JointModel &joint) {
    return (boost::get<Joints>(&joint.toVariant()) || ...);
  }

  template <class Function>
  static void visit(const pinocchio::JointModel &joint, pinocchio::JointData &own, const Function &function) {
    const auto called = [&](const auto *one) {
      using Own = typename std::decay_t<decltype(*one)>::JointDataDerived;
      if (one) function(*one, boost::get<Own>(own.toVariant()));
      return one != nullptr;
    };
    (void)(called(boost::get<Joints>(&joint.toVariant())) || ...);
  }
};
using Common = Compiled<pinocchio::JointModelRZ, pinocchio::JointModelFreeFlyer, pinocchio::JointModelRX,
                        pinocchio::JointModelRY, pinocchio::JointModelRUBX, pinocchio::JointModelRUBY,
                        pinocchio::JointModelRUBZ, pinocchio::JointModelRevoluteUnaligned>;

/// pinocchio::aba with its own passes in one piece, less the forces between bodies, which are not read: the
/// accelerations are the same to the last bit.
__attribute__((flatten)) void forward_dynamics(const pinocchio::Model &model, pinocchio::Data &data, const Given &q,
                                               const Given &v, const Numbers &effort) {
  namespace passes = pinocchio::impl;
  using Outward = passes::AbaLocalConventionForwardStep1<double, 0, pinocchio::JointCollectionDefaultTpl, Given, Given>;
  using Inward = passes::AbaLocalConventionBackwardStep<double, 0, pinocchio::JointCollectionDefaultTpl>;
  const auto count = static_cast<pinocchio::JointIndex>(model.njoints);
  data.v[0].setZero();
  data.a_gf[0] = -model.gravity;
  data.u = effort;
  for (pinocchio::JointIndex i = 1; i < count; ++i)
    Common::visit(model.joints[i], data.joints[i],
                  [&](const auto &joint, auto &own) { Outward::algo(joint, own, model, data, q, v); });
  for (pinocchio::JointIndex i = count - 1; i > 0; --i)
    Common::visit(model.joints[i], data.joints[i],
                  [&](const auto &joint, auto &own) { Inward::algo(joint, own, model, data); });
  for (pinocchio::JointIndex i = 1; i < count; ++i)
    Common::visit(model.joints[i], data.joints[i], [&](const auto &joint, auto &own) {
      data.a_gf[i] += data.liMi[i].actInv(data.a_gf[model.parents[i]]);
      joint.jointVelocitySelector(data.ddq).noalias() =
          own.Dinv * joint.jointVelocitySelector(data.u) - own.UDinv.transpose() * data.a_gf[i].toVector();
      data.a_gf[i] += own.S * joint.jointVelocitySelector(data.ddq);
    });
}

struct Tree final : Evaluator {
  const pinocchio::Model &model;
  pinocchio::Data data;
  ApinTreeArrays at;
  bool common = true;

  Tree(const pinocchio::Model &model_, const ApinTreeArrays &arrays) : model(model_), data(model_), at(arrays) {
    for (pinocchio::JointIndex i = 1; i < model.joints.size(); ++i) common = common && Common::takes(model.joints[i]);
  }

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
    if (tree.common)
      forward_dynamics(tree.model, tree.data, Given(tree.q()), Given(tree.v()), effort);
    else
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
