/* redman/object.h: objects of your own. Experimental. */
#ifndef REDMAN_OBJECT_H
#define REDMAN_OBJECT_H
#include <redman/pool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An object has shapes, a mass, moments of inertia and the friction of its surface, and is used by
 * its name: in option object=NAME of the tasks of hands, and by rdm_scene_add_object in a scene.
 * Those of the YCB set are found by their number too ("025_mug"), with or without it.
 *
 *   rdm_object_def d;  int32_t object;
 *   rdm_shape_def s = {.kind = RDM_SHAPE_BOX, .size = {0.02, 0.03, 0.06}};
 *   rdm_object_def_init(&d, sizeof d);
 *   d.name = "my_box";  d.shapes = &s;  d.num_shapes = 1;  d.mass = 0.2;
 *   if (rdm_object_create(&object, &d)) puts(rdm_last_error());
 * / */
/* frozen layout: a shape of a body or an object, or a fixed one */
typedef struct rdm_shape_def {
  const char *name;        /* unique in the scene; NULL: that of the body. Unused in an object */
  const char *material;    /* of rdm_scene_add_material; NULL: "default". Unused in an object */
  const double *points;    /* [num_points][3] of an RDM_SHAPE_HULL: 4 to 32 points, m; else NULL */
  int32_t num_points;      /* count */
  int32_t kind;            /* RDM_SHAPE_SPHERE ... RDM_SHAPE_HULL; an RDM_SHAPE_PLANE is fixed */
  double size[3];          /* as rdm_shape_info, m; unused in a hull */
  rdm_pose pose;           /* in the frame of the body, or in the world */
  uint8_t color[4];        /* red, green, blue, 255; all 0: grey */
  int32_t seen_only;       /* flag: it is only seen, nothing touches it */
} rdm_shape_def;
#define RDM_MAX_SHAPES 64 /* most shapes of an object */
typedef struct rdm_object_def { /* a whole object; rdm_object_create copies it with its shapes */
  uint32_t struct_size;    /* bytes, set by rdm_object_def_init */
  int32_t num_shapes;      /* 1 to RDM_MAX_SHAPES */
  const char *name;        /* letters, digits, '_', '-', '+'; at most 25 */
  const char *alias;       /* another name; NULL: none */
  const char *summary;     /* one line; NULL: none */
  const char *material;    /* name of its surface's material in scenes; NULL: "object" */
  const rdm_shape_def *shapes; /* [num_shapes] in one frame of your choice; that of a body has its
                                * origin at the centre of mass and the same axes */
  double mass;             /* kg, 1e-6 to 1000 */
  double moment[6];        /* xx yy zz xy xz yz, kg m2; the frame's origin is the centre of mass
                            * then. All 0: of the shapes as solids of one density; where two
                            * overlap, both count */
  double friction;         /* friction coefficient, on dry surfaces, 0 to 10; default 0.5 */
} rdm_object_def;
RDM_API rdm_result rdm_object_def_init(rdm_object_def *def,
                                       size_t size); /* defaults into the first `size` bytes */
/* What rdm_object_create took, with the moments about the centre of mass, but for the shapes, which
 * are NULL here. Shape i < num_shapes is in the frame at the centre of mass; the points of a hull
 * live as long as the object. */
RDM_API rdm_result rdm_object_get_def(int32_t object, rdm_object_def *io);
RDM_API rdm_result rdm_object_shape_at(int32_t object, int32_t i, rdm_shape_def *out);
/* Adds an object and writes its number to *out, for rdm_object_info_at and the functions here.
 * ARGUMENT, RANGE: the text names the row; ARGUMENT for a name that is already used. Objects belong
 * to the process; any number of threads may read them meanwhile. */
RDM_API rdm_result rdm_object_create(int32_t *out, const rdm_object_def *def);
/* Returns what rdm_object_create would, but for a name that is already used; adds nothing. */
RDM_API rdm_result rdm_object_check(const rdm_object_def *def);
/* Pools that have it keep it. ARGUMENT for the library's own. */
RDM_API rdm_result rdm_object_destroy(int32_t object);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_OBJECT_H */
