/*
 * gearmath.h: generated, do not edit.
 *
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GEARMATH_H
#define GEARMATH_H

#include "gm_status.h"
#include "gm_cutter_surface.h"
#include "gm_cradle_pose.h"
#include "gm_flank_family.h"
#include "gm_meshing.h"
#include "gm_axis_transform.h"
#include "gm_tool_pose.h"
#include "gm_point_deviation.h"
#include "gm_setting_sensitivity.h"
#include "gm_deviation_surface.h"
#include "gm_line_entry.h"
#include "gm_moved_settings.h"
#include "gm_seen_from_tool.h"
#include "gm_cubic_block.h"
#include "gm_quintic_block.h"
#include "gm_axes_by_roll.h"
#include "gm_pace_in_cubic_block.h"
#include "gm_pace_in_quintic_block.h"
#include "gm_flank_point.h"
#include "gm_flank_on_line.h"
#include "gm_compensation_step.h"

#endif
