/* Contraction and splitting of boxes: the same numbers as synth.bounds computes over arrays. */

#include "vectors.h"
#include "margins.h"
#include "box_record.h"
#include "rules.h"
#include "box_list.h"
#include "box_steps.h"
#include "subtrees.h"
