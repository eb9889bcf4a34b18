/*
 * Plain C interface to the machine code of Pinocchio and coal, for compiled loops that call by address.
 *
 * The shim stores no physics of its own. It evaluates Pinocchio's dynamics of a tree and coal's distances of
 * pairs of shapes, with the objects that Python has made: their addresses come from the bindings
 * (antenna_pin/compiled/native.py), so that no model is read twice. The objects must outlive the evaluators
 * made of them; Python holds both.
 *
 * All numbers are doubles in SI units, in arrays of the caller's, whose addresses an evaluator stores once. A
 * call then takes nothing but the evaluator, and needs no lock of the interpreter's. An evaluator belongs to
 * one run, hence to one thread at a time; models are only read.
 *
 * Every function that computes returns a status. An exception of C++ ends there: its text is stored in the
 * evaluator. The results are bit for bit those of the bindings, since the same functions of the same libraries
 * compute them; forward dynamics of common joints by passes that are compiled here from the library's headers.
 */
#ifndef ANTENNA_PIN_SHIM_H
#define ANTENNA_PIN_SHIM_H

#include <stdint.h>

#define APIN_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

/* Status of a call: as ANSWERED and REFUSED in antenna_pin/dynamics/outside_kernels.py. */
enum { APIN_ANSWERED = 0, APIN_REFUSED = 1 };

/* Number of this interface: raised with every change of it. */
enum { APIN_INTERFACE = 1 };

/* Longest text of an error, with its end. */
enum { APIN_TEXT = 400 };

/* Marker of a text in the file that tells what it was compiled of, up to the next line's end, as JSON:
 * interface, Pinocchio, coal, Eigen, Eigen's alignment [bytes], digest of the sources, compiler. It is read
 * before the file is loaded (antenna_pin/compiled/native.py). */
#define APIN_MARKER "antenna_pin shim: "

/* Instruction set that Eigen uses here, as eigenpy tells that of the bindings. */
APIN_API const char *apin_instruction_set(void);

/* --- dynamics of a tree: one evaluator for each run ------------------------------------------------------ */

/* Arrays of a run. */
typedef struct {
  const double *state;  /* [q (nq), v (nv), ...] */
  const double *effort; /* generalized force, (nv,) */
  double *acceleration; /* generalized acceleration, (nv,), written */
  double *mass;         /* mass matrix, (nv, nv), symmetric, written */
  double *bias;         /* bias forces, (nv,), written */
} ApinTreeArrays;

/*
 * Evaluator of a tree, with Pinocchio data of its own; null if there is no memory.
 *   model   address of a pinocchio::Model
 *   arrays  copied
 */
APIN_API void *apin_tree(const void *model, const ApinTreeArrays *arrays);

/* Sizes nq and nv of the model and its gravity (6,), linear first: by these an address is checked. */
APIN_API void apin_tree_sizes(const void *tree, int64_t *nq, int64_t *nv, double *gravity);

/* The time t [s] is without meaning: compiled code calls all functions alike. */

/* acceleration = pinocchio::aba(q, v, effort); nothing else of its results. */
APIN_API int64_t apin_acceleration(double t, void *tree);

/* mass = pinocchio::crba(q), both triangles; bias = pinocchio::nonLinearEffects(q, v). */
APIN_API int64_t apin_terms(double t, void *tree);

/* --- distances of pairs of shapes: one evaluator for each joint ------------------------------------------ */

/* Shape that is turned in a pair. */
enum { APIN_NONE = 0, APIN_FIRST = 1, APIN_SECOND = 2, APIN_PLANE = 3 };

/*
 * A pair of shapes, and where a query of it stands.
 *   turned   which shape has a rotation (APIN_FIRST, APIN_SECOND); the other, and both of APIN_NONE, have
 *            none. APIN_PLANE: the second is a half-space, given anew in every query
 *   bit      of ``asked`` that requests this pair
 *   places   null: at the origin
 *   turn     rotation, row by row; of APIN_PLANE normal (3), then distance from the origin [m]
 */
typedef struct {
  const void *functor;     /* coal::ComputeDistance */
  const void *request;     /* coal::DistanceRequest */
  void *plane;             /* coal::Halfspace of APIN_PLANE; null otherwise */
  int64_t turned;
  int64_t bit;
  const int64_t *asked;
  const double *first;     /* place of the first shape, (3,) [m] */
  const double *second;    /* place of the second shape, (3,) [m] */
  const double *turn;
  double *distance;        /* [m], written, negative in penetration */
  double *normal;          /* from the first to the second shape, (3,), written */
  double *point;           /* nearest point of the first shape, (3,) [m], written; null: not wanted */
} ApinPair;

/* Evaluator of the pairs of a joint; null if there is no memory. Pairs are copied. */
APIN_API void *apin_pairs(const ApinPair *pairs, int64_t count);

/* Evaluate all requested pairs. */
APIN_API int64_t apin_distances(double t, void *pairs);

/* --- errors and memory ----------------------------------------------------------------------------------- */

/* Text of the last error of an evaluator; empty if there was none. */
APIN_API const char *apin_error(const void *evaluator);

/* Free an evaluator. */
APIN_API void apin_free(void *evaluator);

/* Raise an exception inside, for tests of what becomes of it. */
APIN_API int64_t apin_fail(double t, void *evaluator);

#ifdef __cplusplus
}
#endif

#endif
