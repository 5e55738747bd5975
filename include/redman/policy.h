/* redman/policy.h: the frozen network. Stable since 1.0. */
#ifndef REDMAN_POLICY_H
#define REDMAN_POLICY_H
#include <redman/base.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rdm_policy rdm_policy; /* handle */
typedef struct rdm_policy_info { /* what a policy file says of its network */
  uint32_t struct_size;       /* in: bytes */
  int32_t obs_dim;            /* count */
  int32_t action_dim;         /* count */
  int32_t action_repeat;      /* control steps to hold each action */
  float control_dt;           /* s, 0: unknown */
  float noise_correlation;    /* AR(1) coefficient of the noise it was trained with */
  uint64_t layout_hash;       /* 0: unknown */
  uint64_t num_params;        /* of the network */
  const char *task;           /* "" for a host's own environment */
  const char *activation;     /* of the hidden layers: "tanh", "elu", "relu"; static */
  int32_t num_points;         /* points of the cloud beside each row, for rdm_policy_act_points; 0:
                               * it reads no clouds */
  int32_t num_point_classes;  /* number of classes of points that it distinguishes; 0: none */
  int32_t num_features;       /* number of features that its encoder computes from a cloud; 0: no
                               * encoder */
  int32_t point_color;        /* whether it reads the colours of points: 0, 1 */
  int32_t num_fields;         /* for rdm_policy_field_at; 0: the file has none */
  int32_t novelty;            /* whether rdm_policy_novelty is available: 0, 1 */
  uint64_t generation;        /* which network it is: the low 32 bits are the epochs that its agent
                               * had learned, the high ones a checksum. Data sampled by another
                               * generation are stale. 0: unknown */
  int32_t state_dim;          /* numbers that it remembers of each world, for rdm_policy_act_state;
                               * 0: it has no memory */
  int32_t reserved2;          /* 0 */
} rdm_policy_info;
RDM_API rdm_result rdm_policy_read(rdm_policy **out, const void *bytes,
                                   size_t size); /* copies bytes [size] */
RDM_API rdm_result rdm_policy_read_file(rdm_policy **out,
                                        const char *path); /* NOT_FOUND, FORMAT ... */
/* For programs without a heap: the bytes that rdm_policy_read_in needs for the file bytes [size].
 * Errors are those of rdm_policy_read, except that of a network which does not reproduce the file's
 * example. */
RDM_API rdm_result rdm_policy_read_memory(const void *bytes, size_t size, size_t *memory);
/* As rdm_policy_read of bytes [size], which are not needed afterwards, into memory [capacity] at
 * any address, which the caller keeps until the policy is destroyed. Neither this call nor later
 * ones on the policy use heap or hooks, except that rdm_policy_get_tensor and calls that fail may
 * use the heap for a moment. RANGE where capacity is less than rdm_policy_read_memory says. */
RDM_API rdm_result rdm_policy_read_in(rdm_policy **out, const void *bytes, size_t size,
                                      void *memory, size_t capacity);
RDM_API void rdm_policy_destroy(rdm_policy *p);             /* NULL is fine */
RDM_API rdm_result rdm_policy_get_info(const rdm_policy *p, rdm_policy_info *io); /* fills io */
RDM_API size_t rdm_policy_scratch(const rdm_policy *p, int32_t rows); /* bytes for act, at any
                                                                       * address; 0: bad
                                                                       * arguments */
/* One decision, to be held for rdm_policy_info.action_repeat control steps (rdm_actor_act counts
 * them): action [rows][action_dim] = clip(mean + std noise, -1, 1) for obs [rows][obs_dim]. noise
 * [rows][action_dim] are standard normal numbers of the caller's; NULL: the mean. scratch
 * [scratch_bytes]: rdm_policy_scratch bytes or more, of any alignment. No heap, no hidden state:
 * any number of threads, each with its own scratch. ARGUMENT when obs or noise is not finite, or so
 * large that the network overflows (action is written then, but meaningless). STATE for a policy
 * that reads points or has a memory. */
RDM_API rdm_result rdm_policy_act(const rdm_policy *p, const float *obs, int32_t rows,
                                  const float *noise, float *action, void *scratch,
                                  size_t scratch_bytes);
/* The same without clipping, as rdm_agent_act samples, so that an agent can learn from decisions
 * that were sampled elsewhere (rdm_agent_put): action [rows][action_dim] = mean + std noise, and
 * mean [rows][action_dim], for obs [rows][obs_dim] and noise [rows][action_dim], NULL: none. One of
 * action and mean may be NULL. scratch [scratch_bytes] and errors as of rdm_policy_act. */
RDM_API rdm_result rdm_policy_sample(const rdm_policy *p, const float *obs, int32_t rows,
                                     const float *noise, float *action, float *mean,
                                     void *scratch, size_t scratch_bytes);
/* How far observations are from those of training: novelty [rows] of obs [rows][obs_dim]. About 1
 * is the most that training saw, and 2 is far from it.
 *
 *   z_j = (x_j - mean_j) / deviation_j, of the m entries x of a row that the policy reads
 *   novelty = max(sqrt(sum of z_j^2 / m) / a, max of |z_j| / b)
 *
 * mean and deviation are those of the normaliser, over all rows in training (with options
 * obs_freeze and obs_count_max, over those that it counts); a deviation is at least 0.01. Over the
 * last epochs, of 1000 rows or more (after cloning, over the recording), one row in a thousand had
 * a root mean square of z above a, and one in a thousand a largest |z| above b. It does not notice
 * values that are usual one by one and unusual together, such as a sensor that is stuck at a usual
 * value, nor a value that is unusual for its entry but usual for another; it ignores clouds.
 * UNSUPPORTED, and rdm_policy_info.novelty 0, where the file lacks these statistics: a file of 0.1,
 * or of an agent without normalize_obs, or of one that has not learned from 1000 rows since its
 * statistics were given to it. ARGUMENT when obs is not finite. No heap; any number of threads. */
RDM_API rdm_result rdm_policy_novelty(const rdm_policy *p, const float *obs, int32_t rows,
                                      float *novelty);
/* Tensor i of the policy: "actor.0.weight" (rows outputs, cols inputs) and so on, "actor.log_std"
 * or "actor.log_std_bounds", "normalizer.shift|scale|clip", "example.obs|action". RANGE ends the
 * list. Inputs are whole rows of obs_dim; weights of entries that the policy does not read are 0.
 * In a policy that reads points, "actor.0.weight" has further columns for the features, and there
 * are "encoder.0.weight" and so on, "encoder.origin" and "encoder.range", in m,
 * "encoder.activation" (0 tanh, 1 elu, 2 relu), "example.points", in m, and
 * "example.point_class". In a policy with a GRU there are "memory.input.weight" and ".bias" and
 * "memory.state.weight" and ".bias", rows of the gates r, z and n; the GRU stands before the last
 * layer. In one with a history "actor.0.weight" has further columns, for its state, and there is
 * "history.columns", which entries of a row it keeps of each decision. "action.squash" is there
 * where actions are squashed: 1 tanh(mean + noise), 2 tanh(mean) + noise, then the clip. */
RDM_API rdm_result rdm_policy_tensor_at(const rdm_policy *p, int32_t i, rdm_tensor *out);
/* Copies the named tensor to out [count]; count must be rows * cols. NOT_FOUND, RANGE. */
RDM_API rdm_result rdm_policy_get_tensor(const rdm_policy *p, const char *name, float *out,
                                         size_t count);
/* Field i of an observation; its strings live as long as the policy, its bounds are unknown. RANGE
 * ends the list. */
RDM_API rdm_result rdm_policy_field_at(const rdm_policy *p, int32_t i, rdm_field_info *io);
/* Whether the policy fits a pool of this spec: OK, or VERSION_MISMATCH with a text that says which
 * member of the spec differs. Where the layout differs, the text names the first field that does,
 * if the policy file lists its fields and a pool of the spec's layout exists. */
RDM_API rdm_result rdm_policy_check(const rdm_policy *p, const rdm_spec *spec);
/* Which entries of a row of obs_dim the policy reads (agent option actor_obs), ascending: writes up
 * to capacity of them to columns [capacity]; *count is how many there are. */
RDM_API rdm_result rdm_policy_get_columns(const rdm_policy *p, int32_t *columns, size_t capacity,
                                          size_t *count);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_POLICY_H */
