/* redman/robot.h: robots of your own. Experimental. */
#ifndef REDMAN_ROBOT_H
#define REDMAN_ROBOT_H
#include <redman/pool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A robot is a tree of links on a root, as plain arrays; the library's own are described in the
 * same way (rdm_robot_get_def, rdm_robot_link_at ...). Frames: a link's frame is that of its joint;
 * it is at `pose` in its parent's frame while the joint is at 0, and rotates about (slides along)
 * its own `axis`. A hand is described as a right hand, with its fingers and palm; options hand= and
 * arm= of the hand tasks take robots by name.
 *
 *   rdm_robot_def d;  int32_t robot;
 *   rdm_robot_def_init(&d, sizeof d);
 *   d.name = "my_hand";  d.kind = RDM_ROBOT_HAND;  d.links = links;  d.num_links = 9; ...
 *   if (rdm_robot_create(&robot, &d)) puts(rdm_last_error());          names the row and the number
 *   config.settings = "hand=my_hand\narm=ur5e";  ... rdm_pool_create(&p, &config) ...
 *   rdm_robot_destroy(robot);
 *
 * Robots belong to the process; any number of threads may read while others add and remove. */
enum rdm_robot_kind { RDM_ROBOT_OTHER = 0, RDM_ROBOT_HAND = 1, RDM_ROBOT_ARM = 2 }; /* of a robot */
enum rdm_link_row { RDM_LINK_ROOT = -1, RDM_LINK_NONE = -2 };  /* instead of a row of links */
#define RDM_MAX_LINKS 64   /* links of a robot, at most */
#define RDM_MAX_KNOTS 4    /* knots of a curve, at most */
/* frozen layout: a link and the joint that moves it; m, rad, kg, N, s */
typedef struct rdm_robot_link {
  const char *name;        /* of the link, unique */
  const char *joint;       /* of the joint, unique */
  int32_t parent;          /* an earlier row, RDM_LINK_ROOT */
  int32_t kind;            /* RDM_JOINT_REVOLUTE, RDM_JOINT_PRISMATIC */
  rdm_pose pose;           /* in the parent's frame with the joint at 0 */
  double axis[3];          /* in the link's own frame, unit */
  double lower;            /* range, below upper */
  double upper;            /* range */
  double velocity;         /* how fast the drive's target may move; 0: at once */
  double kp;               /* stiffness of the drive, whose effort is kp (target - q) - kd qd */
  double kd;               /* damping of the drive */
  double effort;           /* largest effort of the drive, N m (N) */
  double armature;         /* inertia added about the axis, kg m2; revolute joints alone */
  double friction;         /* dry friction, N m (N) */
  double mass;             /* 0 with moments of 0: massless */
  double com[3];           /* centre of mass in the link's frame */
  double moment[6];        /* xx yy zz xy xz yz about com, axes of the link */
} rdm_robot_link;
typedef struct rdm_robot_shape { /* frozen layout: a shape of a link, which can be touched and
                                  * seen */
  const char *name;        /* unique */
  int32_t link;            /* row, RDM_LINK_ROOT */
  int32_t kind;            /* RDM_SHAPE_SPHERE, RDM_SHAPE_CAPSULE, RDM_SHAPE_BOX,
                            * RDM_SHAPE_CYLINDER, RDM_SHAPE_ELLIPSOID */
  double size[3];          /* as rdm_shape_info, m */
  rdm_pose pose;           /* in the link's frame */
  uint8_t color[4];        /* red, green, blue, 255 */
  uint8_t reserved[4];     /* 0 */
} rdm_robot_shape;
/* frozen layout: two shapes of one robot that may touch each other */
typedef struct rdm_robot_pair {
  int32_t a, b;            /* rows of shapes */
} rdm_robot_pair;
/* frozen layout: a joint that follows another one, by a tendon or belt */
typedef struct rdm_robot_coupling {
  int32_t link;            /* row whose joint follows */
  int32_t other;           /* row whose joint it follows, which itself follows none */
  double ratio;            /* q = ratio q_other */
  double slack;            /* rad; within it the joint moves freely */
} rdm_robot_coupling;
/* frozen layout: the target of a joint, a piecewise linear function of a command of -1 to 1 */
typedef struct rdm_robot_curve {
  int32_t link;            /* row */
  int32_t driver;          /* row whose command it is a function of: the same row, or that of the
                            * motor */
  int32_t num_knots;       /* 2 to RDM_MAX_KNOTS */
  int32_t reserved;        /* 0 */
  double command[4];       /* ascending */
  double angle[4];         /* in the joint's range, rad (m) */
} rdm_robot_curve;
/* frozen layout: a finger, whose links are the rows from `first` to `tip` */
typedef struct rdm_robot_finger {
  const char *name;        /* short; the names of its observations begin with it */
  int32_t first;           /* row of its first link */
  int32_t tip;             /* row of its last link, which carries the force sensor */
  int32_t lateral;         /* row of the joint that spreads it to a side, -1: none */
  int32_t proximal;        /* row of the joint that bends it at its base, -1: none */
  int32_t middle;          /* row of the next joint that bends it, -1: none */
  int32_t thumb;           /* flag */
  double p_tip[3];         /* its end, in the frame of `tip`, m */
} rdm_robot_finger;
typedef struct rdm_robot_def { /* a whole robot; the arrays are copied by rdm_robot_create */
  uint32_t struct_size;    /* bytes, set by rdm_robot_def_init */
  int32_t kind;            /* RDM_ROBOT_* */
  const char *name;        /* letters, digits, '_', '-', '+'; at most 25 */
  const char *alias;       /* another name; NULL: none */
  const char *summary;     /* one line; NULL: none */
  const rdm_robot_link *links;         /* [num_links] a parent before its children */
  const rdm_robot_shape *shapes;       /* [num_shapes] NULL with num_shapes 0 */
  const rdm_robot_pair *pairs;         /* [num_pairs] NULL with num_pairs 0; num_pairs -1: all
                                        * but neighbours */
  const rdm_robot_coupling *couplings; /* [num_couplings] NULL with num_couplings 0 */
  const rdm_robot_curve *curves;       /* [num_curves] NULL with num_curves 0 */
  const int32_t *commands; /* [num_commands] rows in the order of actions; NULL, with
                            * num_commands 0: all but the followers, by row */
  const rdm_robot_finger *fingers;     /* [num_fingers] the first finger first; NULL with
                                        * num_fingers 0 */
  const double *home;      /* [num_links] start pose, rad (m); NULL: 0, or the limit nearest to
                            * it */
  const double *folded;    /* [num_links] of a hand: fingers straight, thumb across the palm; NULL:
                            * none */
  const float *closed;     /* [num_commands], with 0 of these one for each joint that follows no
                            * other, of a hand: commands that close it around 5 cm; NULL: none */
  int32_t num_links;       /* 1 to RDM_MAX_LINKS */
  int32_t num_shapes;      /* count */
  int32_t num_pairs;       /* count */
  int32_t num_couplings;   /* count */
  int32_t num_curves;      /* count */
  int32_t num_commands;    /* count; -1: none, springs hold the joints at home (RDM_ROBOT_OTHER,
                            * such as a door or scissors) */
  int32_t num_fingers;     /* count */
  int32_t mirror;          /* root axis (0, 1, 2) normal to the plane that mirrors it into a left
                            * one; -1: none */
  double root_mass;        /* of the root link, kg */
  double root_com[3];      /* in the root frame, m */
  double root_moment[6];   /* as rdm_robot_link.moment */
  rdm_pose mount;          /* of hands: the frame, z towards the fingers, that is fixed to an arm's
                            * flange; in the root frame */
  rdm_pose flange;         /* of arms: the frame, z out of the arm, that carries a hand; in
                            * flange_link's frame */
  int32_t flange_link;     /* row, RDM_LINK_NONE */
  int32_t palm_link;       /* row, RDM_LINK_ROOT, RDM_LINK_NONE */
  double palm_p[3];        /* centre of the palm's surface, in palm_link's frame, m */
  double palm_normal[3];   /* unit: out of the palm */
  double palm_fingers[3];  /* unit: where the fingers point; of a gripper any direction in the
                            * palm's plane */
  double hold_p[3];        /* where a held object is, in palm_link's frame, m */
} rdm_robot_def;
RDM_API rdm_result rdm_robot_def_init(rdm_robot_def *def,
                                      size_t size); /* defaults into the first `size` bytes */
/* Adds a robot and writes its number to *out, for rdm_robot_at and the functions below. ARGUMENT,
 * RANGE: the text names the row; ARGUMENT for a name that is already used. Principal moments must
 * be positive and satisfy the triangle inequality. */
RDM_API rdm_result rdm_robot_create(int32_t *out, const rdm_robot_def *def);
/* Pools that use it keep it. ARGUMENT for the library's own. */
RDM_API rdm_result rdm_robot_destroy(int32_t robot);
/* A hand on an arm as a robot of its own, under `name`: its root and the arm's last link are one
 * body. The hand is rotated by `yaw` (rad) about the flange's z and moved out by `adapter` (m);
 * left: its mirror image. UNSUPPORTED unless they are an arm and a hand. */
RDM_API rdm_result rdm_robot_create_mounted(int32_t *out, const char *name, int32_t arm,
                                            int32_t hand, double yaw, double adapter, int32_t left);
/* What rdm_robot_create took, but for the arrays, which are NULL here. */
RDM_API rdm_result rdm_robot_get_def(int32_t robot, rdm_robot_def *io);
RDM_API rdm_result rdm_robot_link_at(int32_t robot, int32_t i,
                                     rdm_robot_link *out); /* i < num_links */
RDM_API rdm_result rdm_robot_shape_at(int32_t robot, int32_t i,
                                      rdm_robot_shape *out); /* i < num_shapes */
RDM_API rdm_result rdm_robot_pair_at(int32_t robot, int32_t i,
                                     rdm_robot_pair *out); /* i < num_pairs */
RDM_API rdm_result rdm_robot_coupling_at(int32_t robot, int32_t i,
                                         rdm_robot_coupling *out); /* i < num_couplings */
RDM_API rdm_result rdm_robot_curve_at(int32_t robot, int32_t i,
                                      rdm_robot_curve *out); /* i < num_curves */
RDM_API rdm_result rdm_robot_finger_at(int32_t robot, int32_t i,
                                       rdm_robot_finger *out); /* i < num_fingers */
/* Numbers of the robot's poses and commands: commands [num_commands], home [num_links],
 * folded [num_links] and closed [num_commands] may be NULL. The counts are those of
 * rdm_robot_get_def; folded and closed are 0 where it has none. */
RDM_API rdm_result rdm_robot_get_postures(int32_t robot, int32_t *commands, double *home,
                                          double *folded, float *closed);
/* Forward kinematics for joints q [num_links], in the root frame: writes the poses of the links to
 * links [num_links], of the flange to *flange, of the fingertips to tips [num_fingers][3] and of
 * the palm to *palm (origin at hold_p, y into the palm, z as the fingers point). flange, tips and
 * palm may be NULL. UNSUPPORTED where the flange or the palm is asked of a robot without one;
 * nothing is written then. */
RDM_API rdm_result rdm_robot_get_poses(int32_t robot, const double *q, rdm_pose *links,
                                       rdm_pose *flange, double *tips, rdm_pose *palm);
/* Inverse kinematics: moves joints q [num_links], from where they are, to where the arm's flange
 * has the pose `flange` in the root frame. *found is 0 when the least squares end elsewhere.
 * UNSUPPORTED for a robot without a flange. */
RDM_API rdm_result rdm_robot_reach(int32_t robot, const rdm_pose *flange, double *q,
                                   int32_t *found);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_ROBOT_H */
